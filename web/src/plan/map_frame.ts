// Paper and scale of a map: from metres to pixels, with rulers at its edges.

import { themed } from "../base/colours";
import { niceStep } from "../base/format";

const kMargin = { left: 46, right: 12, top: 10, bottom: 34 };

export class MapFrame {
  private scale: number;
  private left: number;
  private bottom: number;

  /// `low` and `high`: what has to be on the map, m. Both axes have the same scale.
  constructor(private width: number, private height: number, low: [number, number], high: [number, number]) {
    const w = width - kMargin.left - kMargin.right;
    const h = height - kMargin.top - kMargin.bottom;
    const span = [Math.max(high[0] - low[0], 0.5), Math.max(high[1] - low[1], 0.5)];
    this.scale = Math.min(w / (1.1 * span[0]), h / (1.1 * span[1]));
    this.left = kMargin.left + w / 2 - (this.scale * (low[0] + high[0])) / 2;
    this.bottom = kMargin.top + h / 2 + (this.scale * (low[1] + high[1])) / 2;
  }

  get perMetre(): number {
    return this.scale;
  }

  /// Of the part inside of the rulers, px.
  get edges(): { left: number; right: number; top: number; base: number } {
    return { left: kMargin.left, right: this.width - kMargin.right, top: kMargin.top, base: this.height - kMargin.bottom };
  }

  /// Nearer or farther by a factor about a place of the map, px, and moved by some px.
  zoom(factor: number, x: number, y: number, dx = 0, dy = 0): void {
    this.scale *= factor;
    this.left = x + factor * (this.left - x) + dx;
    this.bottom = y + factor * (this.bottom - y) + dy;
  }

  /// Two frames with the same key put everything in the same place.
  key(): string {
    return [this.width, this.height, this.scale, this.left, this.bottom].map((v) => v.toFixed(3)).join();
  }

  metres(x: number, y: number): [number, number] {
    return [(x - this.left) / this.scale, (this.bottom - y) / this.scale];
  }

  x(metres: number): number {
    return this.left + this.scale * metres;
  }

  y(metres: number): number {
    return this.bottom - this.scale * metres;
  }

  /// Lines and figures each round number of metres.
  drawRulers(c: CanvasRenderingContext2D, labels: [string, string]): void {
    const step = niceStep(90 / this.scale);
    const digits = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
    c.font = "11px system-ui, sans-serif";
    c.lineWidth = 1;
    c.strokeStyle = themed("grid");
    c.fillStyle = themed("muted");
    const right = this.width - kMargin.right;
    const base = this.height - kMargin.bottom;
    c.textAlign = "center";
    c.textBaseline = "top";
    for (const m of this.steps((kMargin.left - this.left) / this.scale, (right - this.left) / this.scale, step)) {
      line(c, this.x(m), kMargin.top, this.x(m), base);
      c.fillText(text(m, digits), this.x(m), base + 4);
    }
    c.fillText(labels[0], (kMargin.left + right) / 2, base + 18);
    c.textAlign = "right";
    c.textBaseline = "middle";
    for (const m of this.steps((this.bottom - base) / this.scale, (this.bottom - kMargin.top) / this.scale, step)) {
      line(c, kMargin.left, this.y(m), right, this.y(m));
      c.fillText(text(m, digits), kMargin.left - 6, this.y(m));
    }
    c.save();
    c.translate(11, (kMargin.top + base) / 2);
    c.rotate(-Math.PI / 2);
    c.textAlign = "center";
    c.fillText(labels[1], 0, 0);
    c.restore();
  }

  /// Nothing is drawn beyond the rulers until the context is restored.
  clip(c: CanvasRenderingContext2D): void {
    const { left, right, top, base } = this.edges;
    c.save();
    c.beginPath();
    c.rect(left, top, right - left, base - top);
    c.clip();
  }

  private *steps(low: number, high: number, step: number): Generator<number> {
    for (let k = Math.ceil(low / step); k * step <= high; ++k) yield k * step;
  }
}

function line(c: CanvasRenderingContext2D, x0: number, y0: number, x1: number, y1: number): void {
  c.beginPath();
  c.moveTo(Math.round(x0) + 0.5, Math.round(y0) + 0.5);
  c.lineTo(Math.round(x1) + 0.5, Math.round(y1) + 0.5);
  c.stroke();
}

function text(metres: number, digits: number): string {
  return metres.toFixed(digits).replace(/^-(?=.*[1-9])/, "−").replace(/^-/, "");
}
