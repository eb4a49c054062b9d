// Lines and marks of a map, drawn with any 2-D context.

import { css, kKinds, kLoopColour, kMapColour, themed } from "../base/colours";
import { colourScale } from "../model/colouring";
import type { Vec3 } from "../base/geometry";
import { poseAt, type Track } from "../model/track";
import type { View } from "../model/view";

/// Place on the map, px, of a point near a pose of a track.
export type Placing = (track: Track, p: Vec3, pose: number) => [number, number];

type Context = CanvasRenderingContext2D;

function way(place: Placing, track: Track): [number, number][] {
  return track.position.map((p, i) => place(track, p, i));
}

export function drawWays(c: Context, view: View, tracks: Track[], place: Placing): void {
  const { active, shown } = view;
  const track = active.value;
  const path = track.run.evaluation?.path;
  if (shown.value.reference && path && track.kind !== "map") {
    strokeLine(c, path.x.map((x, i) => place(track, [x, path.y[i], path.z[i]], poseAt(track, path.t_s[i]))), themed("ink"), 1.2);
  }
  for (const other of tracks) {
    if (other !== track) strokeLine(c, way(place, other), kKinds[view.tracks.indexOf(other) % kKinds.length], 1.6);
  }
  if (shown.value.others) {
    for (const other of view.others()) {
      strokeLine(c, other.position.map((p, i) => place(track, p, poseAt(track, other.t_s[i]))), themed("muted"), 1.4, [2, 3]);
    }
    const times = track.run.map?.path?.t_s;
    if (track.kind !== "map" && track.inMap.length > 1) {
      strokeLine(c, track.inMap.map((p, i) => place(track, p, times ? poseAt(track, times[i]) : i)), kMapColour, 1.6, [6, 4]);
    }
  }
  drawColoured(c, track, place, colourScale(track, view.colouring.value).colours);
}

function strokeLine(c: Context, points: [number, number][], colour: string, width: number, dashes: number[] = []): void {
  if (points.length < 2) return;
  c.strokeStyle = colour;
  c.lineWidth = width;
  c.setLineDash(dashes);
  c.beginPath();
  points.forEach(([x, y], i) => (i === 0 ? c.moveTo(x, y) : c.lineTo(x, y)));
  c.stroke();
  c.setLineDash([]);
}

/// A line between the poses that a loop joins, and a dot at the later one.
export function drawLoops(c: Context, track: Track, place: Placing): void {
  c.strokeStyle = c.fillStyle = kLoopColour;
  c.lineWidth = 1.3;
  if (track.t_s.length === 0) return;
  for (const loop of track.run.map?.loops ?? []) {
    const before = poseAt(track, loop.old_t_s ?? loop.new_t_s), now = poseAt(track, loop.new_t_s);
    const [x, y] = place(track, track.position[now], now);
    strokeLine(c, [place(track, track.position[before], before), [x, y]], kLoopColour, 1.3);
    c.beginPath();
    c.arc(x, y, 2.2, 0, 2 * Math.PI);
    c.fill();
  }
}

/// A triangle where a tag or another control point was seen first; blunders are left out.
export function drawControl(c: Context, track: Track, place: Placing): void {
  const seen = new Set<string>();
  if (track.t_s.length === 0) return;
  for (const { name, t_s, is_blunder } of track.run.map?.control ?? []) {
    if (is_blunder || seen.has(name)) continue;
    seen.add(name);
    const pose = poseAt(track, t_s);
    const [x, y] = place(track, track.position[pose], pose);
    c.fillStyle = themed("surface");
    c.strokeStyle = themed("ink");
    c.lineWidth = 1.4;
    c.beginPath();
    c.moveTo(x, y - 6);
    c.lineTo(x + 5.5, y + 4);
    c.lineTo(x - 5.5, y + 4);
    c.closePath();
    c.fill();
    c.stroke();
    label(c, name, x + 8, y - 6);
  }
}

/// A word that can be read on any ground.
export function label(c: Context, text: string, x: number, y: number, align: CanvasTextAlign = "left"): void {
  c.font = "11px system-ui, sans-serif";
  c.textAlign = align;
  c.textBaseline = "middle";
  c.lineWidth = 3;
  c.lineJoin = "round";
  c.strokeStyle = themed("surface");
  c.strokeText(text, x, y);
  c.fillStyle = themed("ink");
  c.fillText(text, x, y);
}

function drawColoured(c: Context, track: Track, place: Placing, colours: ([number, number, number] | null)[]): void {
  c.lineWidth = 3;
  c.lineCap = "round";
  const faint = themed("faint");
  const colourAt = (i: number) => {
    const rgb = colours[i];
    return rgb ? css(rgb.map((v) => 8 * Math.round(v / 8)) as [number, number, number]) : faint;
  };
  // Stretches of one colour are drawn at once: thousands of short strokes take seconds where no graphics card helps.
  for (let i = 1; i < track.position.length;) {
    const colour = colourAt(i);
    c.strokeStyle = colour;
    c.beginPath();
    c.moveTo(...place(track, track.position[i - 1], i - 1));
    for (; i < track.position.length && colourAt(i) === colour; ++i) c.lineTo(...place(track, track.position[i], i));
    c.stroke();
  }
  c.lineCap = "butt";
}

/// Small rings where there is a picture to look at.
export function drawPictures(c: Context, track: Track, place: Placing): void {
  c.strokeStyle = themed("ink");
  c.fillStyle = themed("surface");
  c.lineWidth = 1;
  let next = 0;
  for (const picture of track.run.pictures) {
    while (next < track.t_s.length && track.t_s[next] < picture.t_s) ++next;
    if (next >= track.t_s.length) return;
    c.beginPath();
    c.arc(...place(track, track.position[next], next), 2.4, 0, 2 * Math.PI);
    c.fill();
    c.stroke();
  }
}

/// A dot with a wedge that shows where the camera looks, and a line from the pose that is measured from.
export function drawSelection(c: Context, view: View, place: Placing): void {
  const track = view.active.value;
  if (track.position.length === 0) return;
  const pose = view.pose();
  const p = track.position[pose], v = track.view[pose];
  const [x, y] = place(track, p, pose);
  const [x1, y1] = place(track, [p[0] + v[0], p[1] + v[1], p[2] + v[2]], pose);
  const angle = Math.atan2(y1 - y, x1 - x);
  if (view.mark.value !== null) {
    const from = poseAt(track, view.mark.value);
    const [x0, y0] = place(track, track.position[from], from);
    strokeLine(c, [[x0, y0], [x, y]], themed("accent"), 1.6, [5, 3]);
    dot(c, x0, y0, 4);
  }
  c.fillStyle = themed("accent");
  c.globalAlpha = 0.35;
  c.beginPath();
  c.moveTo(x, y);
  c.arc(x, y, 26, angle - 0.45, angle + 0.45);
  c.closePath();
  c.fill();
  c.globalAlpha = 1;
  dot(c, x, y, 6);
}

function dot(c: Context, x: number, y: number, radius: number): void {
  c.fillStyle = themed("accent");
  c.beginPath();
  c.arc(x, y, radius, 0, 2 * Math.PI);
  c.fill();
  c.strokeStyle = themed("surface");
  c.lineWidth = 1.5;
  c.stroke();
}
