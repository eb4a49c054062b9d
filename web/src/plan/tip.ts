// Figures of a pose beside the pointer.

import { colourScale } from "../model/colouring";
import { element } from "../base/dom";
import { clock } from "../base/format";
import type { View } from "../model/view";

export function poseText(view: View, pose: number): string {
  const track = view.active.value;
  const p = track.position[pose].map((v) => v.toFixed(2).replace("-", "−"));
  const value = view.colouring.value === "time" ? "" : `  ${colourScale(track, view.colouring.value).text(pose)}`;
  return `${clock(track.t_s[pose], 1)}  (${p.join(", ")}) m${value}`;
}

export class Tip {
  readonly node = element("div", "tip");

  constructor() {
    this.node.hidden = true;
  }

  /// At a place of the box that holds the tip.
  show(text: string, x: number, y: number, width: number): void {
    this.node.hidden = false;
    this.node.textContent = text;
    this.node.style.left = `${Math.max(0, Math.min(x + 12, width - this.node.offsetWidth - 4))}px`;
    this.node.style.top = `${y + 16}px`;
  }

  hide(): void {
    this.node.hidden = true;
  }
}
