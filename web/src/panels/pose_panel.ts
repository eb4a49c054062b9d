// The selected pose: the picture taken nearest to it and its figures.

import { element } from "../base/dom";
import { clock, number } from "../base/format";
import { nearestIndex, type Picture } from "../model/data";
import { measurePanel } from "./measure";
import { playback } from "./playback";
import type { Track } from "../model/track";
import type { View } from "../model/view";

function figures(track: Track, pose: number): [string, string][] {
  const { states } = track;
  const row = track.row[pose];
  const fixed = (v: number, digits: number) => v.toFixed(digits).replace(/^-(?=[0.]*$)/, "").replace("-", "−");
  const position = ["x", "y", "z"].map((axis) => fixed(states.numbers[`p_${axis} [m]`][row] ?? NaN, 2)).join(", ");
  const plusMinus = (v: number | null, sigma: number | null, digits: number, unit: string) =>
    v === null ? "–" : `${fixed(v, digits)}${unit}${sigma === null ? "" : ` ± ${number(sigma, 2)}${unit}`}`;
  const list: [string, string][] = [
    ["Position", `${position} m`],
    ["one sigma", `${number(track.positionSigma_m[pose], 2)} m`],
    ["Heading", plusMinus(track.heading_deg[pose], track.headingSigma_deg[pose], 1, "°")],
    ["Depth below start", `${fixed(track.depth_m[pose], 2)} m`],
    ...(states.words["status"] ? [["Status", states.words["status"][row]] as [string, string]] : []),
  ];
  if (states.numbers["tracks"]) {
    list.push(["Tracks", `${states.numbers["tracks"][row] ?? "–"}, ${states.numbers["landmarks"]?.[row] ?? "–"} of them landmarks`],
      ["Reprojection", `${number(states.numbers["reprojection_rms [sigma]"]?.[row], 2)} σ`]);
  }
  const magnetometer = states.words["magnetometer"]?.[row];
  if (magnetometer && magnetometer !== "off") list.push(["Magnetometer", magnetometer]);
  if (track.error_m[pose] !== null) list.push(["Error", `${number(track.error_m[pose], 3)} m`]);
  return list;
}

export function posePanel(view: View): HTMLElement {
  const picture = element("img");
  const caption = element("figcaption");
  const figure = element("figure", "picture", picture, caption);
  const table = element("dl", "figures");
  const time = element("strong", "time");
  const slider = element("input");
  slider.type = "range";
  slider.step = "1";
  slider.setAttribute("aria-label", "Pose");
  slider.addEventListener("input", () => view.time.set(view.active.value.t_s[Number(slider.value)]));
  let shown: Picture | null = null;

  const show = () => {
    const track = view.active.value;
    if (track.t_s.length === 0) return;
    const pose = view.pose();
    slider.max = String(track.t_s.length - 1);
    slider.value = String(pose);
    time.textContent = clock(track.t_s[pose], 1);
    table.replaceChildren(...figures(track, pose).flatMap(([name, value]) => [element("dt", "", name), element("dd", "", value)]));
    const { pictures } = track.run;
    figure.hidden = pictures.length === 0;
    if (pictures.length === 0) return;
    const nearest = pictures[nearestIndex(pictures.map((p) => p.t_s), track.t_s[pose])];
    if (nearest === shown) return;
    shown = nearest;
    picture.src = `data:image/jpeg;base64,${nearest.jpeg}`;
    picture.alt = `Image at ${clock(nearest.t_s, 1)} with the points followed in it`;
    caption.textContent = `Frame at ${clock(nearest.t_s, 1)}. Points: blue are new, red were followed for 40 images or more.`;
  };
  view.active.watch(show);
  view.time.watch(show);
  return element("aside", "card pose", element("header", "", element("h3", "", "Selected pose"), time), slider,
    playback(view), figure, table, measurePanel(view));
}
