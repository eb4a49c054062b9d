// A picture or the lines of a survey underneath the plan.

import { themed } from "../base/colours";
import type { Background } from "../model/data";
import type { MapFrame } from "./map_frame";

type Context = CanvasRenderingContext2D;

const kListeners: (() => void)[] = [];
const kImages = new WeakMap<Background, HTMLImageElement>();

export function whenBackgroundLoads(action: () => void): void {
  kListeners.push(action);
}

function imageOf(background: Background): HTMLImageElement | null {
  if (!background.image) return null;
  const kept = kImages.get(background);
  if (kept) return kept;
  const image = new Image();
  image.addEventListener("load", () => kListeners.forEach((listener) => listener()));
  image.src = `data:${background.image.type};base64,${background.image.data}`;
  kImages.set(background, image);
  return image;
}

export function drawBackground(c: Context, background: Background, frame: MapFrame): void {
  const image = imageOf(background);
  if (image?.complete && image.naturalWidth > 0) {
    const { column_m, row_m, first_m } = background.image!;
    const scale = frame.perMetre;
    // The world file tells the middle of the first pixel; a canvas begins at its corner.
    const x = first_m[0] - (column_m[0] + row_m[0]) / 2, y = first_m[1] - (column_m[1] + row_m[1]) / 2;
    c.save();
    c.globalAlpha = 0.6;
    c.transform(scale * column_m[0], -scale * column_m[1], scale * row_m[0], -scale * row_m[1], frame.x(x), frame.y(y));
    c.drawImage(image, 0, 0, image.naturalWidth, image.naturalHeight);
    c.restore();
  }
  c.strokeStyle = themed("faint");
  c.lineWidth = 1.4;
  for (const line of background.lines) {
    c.beginPath();
    line.forEach(([x, y], i) => (i === 0 ? c.moveTo(frame.x(x), frame.y(y)) : c.lineTo(frame.x(x), frame.y(y))));
    c.stroke();
  }
}
