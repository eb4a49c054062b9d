// Drawings as SVG: for print, where pictures of pixels would be coarse, and to take home.

import { Context as SvgContext } from "svgcanvas";
import { button } from "./dom";
import { save } from "./download";

type Context2D = CanvasRenderingContext2D;

export interface VectorDrawing {
  width: () => number; // px of the page
  height: (width: number) => number;
  draw: (context: Context2D, width: number, height: number) => void;
  ratio?: () => number; // of the context to the page; 1 where it is not set
}

/// A path that is remembered, in place of Path2D, which cannot be read.
class RecordedPath {
  readonly calls: [string, number[]][] = [];

  constructor(other?: RecordedPath) {
    if (other) this.calls.push(...other.calls);
  }
}

for (const name of ["moveTo", "lineTo", "rect", "arc", "closePath", "bezierCurveTo", "quadraticCurveTo", "arcTo", "ellipse"]) {
  (RecordedPath.prototype as unknown as Record<string, unknown>)[name] = function (this: RecordedPath, ...values: number[]) {
    this.calls.push([name, values]);
  };
}

type Loose = Record<string, (...values: unknown[]) => unknown>;

/// A 2-D context that writes SVG and takes remembered paths. After `svg()` it draws nothing more.
export function svgContext(width: number, height: number): { context: Context2D; svg: () => SVGSVGElement } {
  const context = new SvgContext({ width, height, document }) as unknown as Loose & { getSvg: () => SVGSVGElement };
  const methods = ["stroke", "fill", "clip"];
  for (const name of methods) {
    const plain = context[name].bind(context);
    context[name] = (path?: unknown) => {
      if (path instanceof RecordedPath) {
        context.beginPath();
        for (const [call, values] of path.calls) context[call](...values);
      }
      return plain();
    };
  }
  const svg = () => {
    const node = context.getSvg().cloneNode(true) as SVGSVGElement;
    node.setAttribute("viewBox", `0 0 ${width} ${height}`);
    // uPlot draws once more when the browser has time.
    for (const name of [...methods, ...Object.keys(Object.getPrototypeOf(context))]) context[name] = () => undefined;
    return node;
  };
  return { context: context as unknown as Context2D, svg };
}

/// Runs an action during which every new canvas draws to this context, and paths are remembered. For packages
/// that make their canvases themselves.
export function drawingOn(context: Context2D, action: () => void): void {
  const { getContext } = HTMLCanvasElement.prototype;
  const { Path2D } = window;
  HTMLCanvasElement.prototype.getContext = (() => context) as unknown as typeof getContext;
  window.Path2D = RecordedPath as unknown as typeof Path2D;
  try {
    action();
  } finally {
    HTMLCanvasElement.prototype.getContext = getContext;
    window.Path2D = Path2D;
  }
}

export function svgOf(drawing: VectorDrawing, width = drawing.width()): SVGSVGElement {
  const height = drawing.height(width);
  const ratio = drawing.ratio?.() ?? 1;
  const { context, svg } = svgContext(ratio * width, ratio * height);
  drawing.draw(context, width, height);
  return svg();
}

export function vectorButton(name: () => string, drawing: VectorDrawing): HTMLButtonElement {
  return button("SVG", "Download this drawing as lines", () => {
    const text = new XMLSerializer().serializeToString(svgOf(drawing));
    save(`${name()}.svg`, new Blob([text], { type: "image/svg+xml" }));
  });
}

/// Before the page is printed, puts the drawing as SVG, so many px wide, in place of its canvas; after it, the
/// canvas again.
export function printable(box: HTMLElement, screen: HTMLElement, drawing: VectorDrawing, width: () => number): void {
  let printed: SVGSVGElement | null = null;
  window.addEventListener("beforeprint", () => {
    printed?.remove();
    if (box.closest("[hidden]")) return;
    printed = svgOf(drawing, width());
    printed.classList.add("printed");
    screen.classList.add("unprinted");
    box.prepend(printed);
  });
  window.addEventListener("afterprint", () => {
    printed?.remove();
    printed = null;
    screen.classList.remove("unprinted");
  });
}

/// Before the page is printed, puts a picture in place of a canvas for drawings in space, which browsers print
/// empty. `draw`: draws in the colours of paper, before the picture is taken.
export function printablePicture(box: HTMLElement, canvas: HTMLCanvasElement, draw: () => void): void {
  window.addEventListener("beforeprint", () => {
    draw();
    const picture = new Image();
    picture.src = canvas.toDataURL("image/png");
    picture.className = "printed";
    box.append(picture);
    canvas.classList.add("unprinted");
    window.addEventListener("afterprint", () => picture.remove(), { once: true });
  });
  window.addEventListener("afterprint", () => canvas.classList.remove("unprinted"));
}
