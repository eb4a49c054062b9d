// What makes a map of a way a survey: stations with the walls beside them, ellipses, a bar of scale, an arrow to north.

import { kKinds, themed } from "../base/colours";
import { niceStep, number } from "../base/format";
import type { Vec3 } from "../base/geometry";
import type { MapFrame } from "./map_frame";
import { label, type Placing } from "./map_paint";
import { wayDirection, type Projection } from "../model/projections";
import { poseAt, type Track } from "../model/track";
import type { View } from "../model/view";
import { worldNames } from "../model/world";

const kNearest_px = 7; // stations nearer to each other would be a black line

type Context = CanvasRenderingContext2D;

export interface PlacedStation {
  index: number; // its name
  pose: number;
  position: Vec3;
  right: Vec3; // horizontal, across the passage
  size_m: (number | null)[]; // left, right, up, down
  splays: Vec3[]; // from the station, in the world that the page shows
}

const kStations = new WeakMap<Track, PlacedStation[]>();

/// The stations of a run on one of its solutions.
export function stationsOf(track: Track): PlacedStation[] {
  const kept = kStations.get(track);
  if (kept) return kept;
  const stations = track.t_s.length === 0 ? [] : (track.run.stations ?? []).map((station, index): PlacedStation => {
    const pose = poseAt(track, station.t_s);
    const ahead = wayDirection(track, pose);
    const scale = track.map.scale;
    return {
      index, pose, position: track.position[pose], right: [ahead[1], -ahead[0], 0],
      size_m: station.left_right_up_down_m.map((v) => (v === null ? null : scale * v)),
      splays: station.splays_m.map((s) => track.map.direction(s).map((v) => scale * v) as Vec3),
    };
  });
  kStations.set(track, stations);
  return stations;
}

function moved(p: Vec3, direction: Vec3, metres: number): Vec3 {
  return p.map((v, k) => v + metres * direction[k]) as Vec3;
}

/// Both walls beside a station as the projection sees them: left and right in plan, up and down from the side.
function wallEnds(station: PlacedStation, isPlan: boolean): (Vec3 | null)[] {
  const axis: Vec3 = isPlan ? station.right : [0, 0, -1];
  const [one, other] = isPlan ? station.size_m.slice(0, 2) : station.size_m.slice(2, 4);
  return [one === null ? null : moved(station.position, axis, -one), other === null ? null : moved(station.position, axis, other)];
}

export function wallsBeside(track: Track, isPlan: boolean): { end: Vec3; pose: number }[] {
  return stationsOf(track).flatMap((station) => wallEnds(station, isPlan).flatMap((end) => (end ? [{ end, pose: station.pose }] : [])));
}

export function drawStations(c: Context, track: Track, place: Placing, isPlan: boolean): void {
  const stations = stationsOf(track);
  let drawn: [number, number] | null = null; // the last one
  let last: [number, number] | null = null; // with its name
  for (const station of stations) {
    const ends = wallEnds(station, isPlan).map((p) => p && place(track, p, station.pose));
    const [x, y] = place(track, station.position, station.pose);
    if (drawn && Math.hypot(x - drawn[0], y - drawn[1]) < kNearest_px) continue;
    drawn = [x, y];
    c.strokeStyle = themed("ink");
    c.lineWidth = 1;
    c.globalAlpha = 0.75;
    for (const end of ends) {
      if (!end) continue;
      c.beginPath();
      c.moveTo(x, y);
      c.lineTo(...end);
      c.stroke();
    }
    c.globalAlpha = 1;
    c.fillStyle = themed("ink");
    c.beginPath();
    c.arc(x, y, 2.6, 0, 2 * Math.PI);
    c.fill();
    if (last && Math.hypot(x - last[0], y - last[1]) < 26) continue;
    last = [x, y];
    label(c, String(station.index), x + 5, y - 8);
  }
}

/// Half axes and turn of the ellipse that a covariance makes on the paper, m and rad from its first axis.
export function ellipseOf(covariance: number[], [a, b]: [Vec3, Vec3]): { major: number; minor: number; angle: number } {
  const [xx, xy, xz, yy, yz, zz] = covariance;
  const matrix = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
  const form = (u: Vec3, v: Vec3) => u.reduce((sum, ui, i) => sum + ui * v.reduce((s, vj, j) => s + matrix[i][j] * vj, 0), 0);
  const uu = form(a, a), uv = form(a, b), vv = form(b, b);
  const middle = (uu + vv) / 2, spread = Math.hypot((uu - vv) / 2, uv);
  return { major: Math.sqrt(Math.max(0, middle + spread)), minor: Math.sqrt(Math.max(0, middle - spread)), angle: Math.atan2(2 * uv, uu - vv) / 2 };
}

/// At each station, at the selected pose and at the end; `times` one sigma.
export function drawEllipses(c: Context, view: View, track: Track, projection: Projection, frame: MapFrame, place: Placing, times: number): void {
  if (track.position.length === 0) return;
  const poses = new Set([...stationsOf(track).map((s) => s.pose), track.position.length - 1, ...(track === view.active.value ? [view.pose()] : [])]);
  for (const pose of poses) {
    const covariance = track.covariance_m2[pose];
    if (!covariance) continue;
    const { major, minor, angle } = ellipseOf(covariance, projection.directions(track, pose));
    const scale = times * frame.perMetre;
    c.beginPath();
    c.ellipse(...place(track, track.position[pose], pose), Math.max(0.5, scale * major), Math.max(0.5, scale * minor), -angle, 0, 2 * Math.PI);
    c.fillStyle = `${kKinds[0]}30`;
    c.fill();
    c.strokeStyle = kKinds[0];
    c.lineWidth = 1;
    c.stroke();
  }
}

/// A bar of a round length at the lower right, with its length.
export function drawScaleBar(c: Context, frame: MapFrame): void {
  const { right, base } = frame.edges;
  const metres = niceStep(140 / frame.perMetre);
  const width = metres * frame.perMetre;
  const x = right - 14 - width, y = base - 16;
  c.fillStyle = themed("surface");
  c.globalAlpha = 0.8;
  c.fillRect(x - 8, y - 20, width + 16, 30);
  c.globalAlpha = 1;
  c.fillStyle = themed("ink");
  c.fillRect(x, y, width, 5);
  c.fillStyle = themed("surface");
  c.fillRect(x + width / 2, y + 1.2, width / 2 - 1.2, 2.6);
  label(c, `${number(metres, 1)} m`, x + width / 2, y - 9, "center");
}

/// Points up: plans are drawn with the world's y axis upwards.
export function drawNorthArrow(c: Context, frame: MapFrame, view: View): void {
  const { left, top } = frame.edges;
  const x = left + 22, y = top + 12;
  c.fillStyle = themed("ink");
  c.strokeStyle = themed("ink");
  c.lineWidth = 1.2;
  c.beginPath();
  c.moveTo(x, y);
  c.lineTo(x + 6, y + 26);
  c.lineTo(x, y + 21);
  c.closePath();
  c.fill();
  c.beginPath();
  c.moveTo(x, y);
  c.lineTo(x - 6, y + 26);
  c.lineTo(x, y + 21);
  c.stroke();
  const { knowsNorth, up } = worldNames(view);
  label(c, !knowsNorth ? "y" : up.includes("magnetic") ? "N magnetic" : "N", x + 10, y + 8);
}
