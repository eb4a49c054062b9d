// From one pose to another: distance, direction and slope.

import { button, element } from "../base/dom";
import { clock, number } from "../base/format";
import { poseAt, type Track } from "../model/track";
import type { View } from "../model/view";
import { worldNames } from "../model/world";

function figures(view: View, track: Track, from: number, to: number): [string, string][] {
  const a = track.position[from], b = track.position[to];
  const d = b.map((v, k) => v - a[k]);
  const flat = Math.hypot(d[0], d[1]);
  const metres = (v: number) => `${v.toFixed(2).replace("-", "−")} m`;
  const azimuth = (((Math.atan2(d[0], d[1]) * 180) / Math.PI) + 360) % 360;
  const slope = (Math.atan2(d[2], flat) * 180) / Math.PI;
  const north = worldNames(view).up;
  return [
    ["Distance", metres(Math.hypot(flat, d[2]))],
    ["horizontal", metres(flat)],
    ["up", metres(d[2])],
    [`Azimuth from ${north}`, flat > 1e-3 ? `${azimuth.toFixed(1)}°` : "–"],
    ["Slope", flat + Math.abs(d[2]) > 1e-3 ? `${slope.toFixed(1).replace("-", "−")}°` : "–"],
    ["Along the way", `${number(Math.abs(track.chainage_m[to] - track.chainage_m[from]), 4)} m`],
  ];
}

export function measurePanel(view: View): HTMLElement {
  const from = element("span", "note");
  const list = element("dl", "figures");
  const clear = button("Clear", "Measure nothing", () => view.mark.set(null));
  const start = button("Measure from here", "Then select another pose, in any view", () => view.mark.set(view.time.value));
  const show = () => {
    const track = view.active.value;
    const mark = view.mark.value;
    clear.hidden = list.hidden = from.hidden = mark === null;
    if (mark === null || track.t_s.length === 0) return;
    const pose = poseAt(track, mark);
    from.textContent = `from ${clock(track.t_s[pose], 1)}; click on another pose`;
    list.replaceChildren(...figures(view, track, pose, view.pose()).flatMap(([name, value]) => [element("dt", "", name), element("dd", "", value)]));
  };
  view.mark.watch(show);
  view.active.watch(show);
  view.time.watch(show);
  return element("div", "measure", element("div", "tools", start, clear), from, list);
}
