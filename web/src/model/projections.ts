// How the way and its surroundings are laid flat: from above, from the side, or unrolled along the way.

import type { Vec3 } from "../base/geometry";
import type { Track } from "./track";
import type { View } from "./view";
import { worldNames } from "./world";

export type ProjectionName = "plan" | "side" | "extended";

export interface Projection {
  title: string;
  axes: [string, string];
  /// A point near a pose of a track; the pose matters only where the way is unrolled.
  flat: (track: Track, p: Vec3, pose: number) => [number, number];
  /// Directions in space of the two axes at a pose.
  directions: (track: Track, pose: number) => [Vec3, Vec3];
  tracks: Track[]; // that have a place on it
  isUnrolled: boolean;
}

export function projectionOf(name: ProjectionName, view: View): Projection {
  return { plan: fromAbove, side: fromTheSide, extended: unrolled }[name](view);
}

function fromAbove(view: View): Projection {
  const names = worldNames(view);
  return {
    title: `Plan, ${names.up} is up`, axes: [names.x, names.y], tracks: view.tracks, isUnrolled: false,
    flat: (_, p) => [p[0], p[1]], directions: () => [[1, 0, 0], [0, 1, 0]],
  };
}

/// Seen across the direction in which the tracks reach farthest.
function fromTheSide(view: View): Projection {
  const { tracks } = view;
  let xx = 0, xy = 0, yy = 0, n = 0, mx = 0, my = 0;
  for (const { position } of tracks) for (const p of position) { mx += p[0]; my += p[1]; ++n; }
  for (const { position } of tracks) {
    for (const p of position) {
      const x = p[0] - mx / n, y = p[1] - my / n;
      xx += x * x; xy += x * y; yy += y * y;
    }
  }
  const angle = Math.atan2(2 * xy, xx - yy) / 2;
  const c = Math.cos(angle), s = Math.sin(angle);
  const bearing = Math.round((90 - (angle * 180) / Math.PI + 360) % 360);
  const along = worldNames(view).knowsNorth ? `along ${String(bearing).padStart(3, "0")}° (m)` : "horizontal (m)";
  return {
    title: "Elevation from the side", axes: [along, "above the start (m)"], tracks, isUnrolled: false,
    flat: (_, p) => [c * p[0] + s * p[1], p[2]], directions: () => [[c, s, 0], [0, 0, 1]],
  };
}

/// Horizontal direction of the way at a pose: to a pose a metre ahead, from one a metre behind.
export function wayDirection(track: Track, pose: number): Vec3 {
  const { position, chainage_m } = track;
  const kReach_m = 1;
  let a = pose, b = pose;
  while (a > 0 && chainage_m[pose] - chainage_m[a] < kReach_m) --a;
  while (b < position.length - 1 && chainage_m[b] - chainage_m[pose] < kReach_m) ++b;
  const d = [position[b][0] - position[a][0], position[b][1] - position[a][1]];
  const length = Math.hypot(d[0], d[1]);
  return length > 1e-6 ? [d[0] / length, d[1] / length, 0] : [1, 0, 0];
}

const kDirections = new WeakMap<Track, Vec3[]>();

function directionOf(track: Track, pose: number): Vec3 {
  let list = kDirections.get(track);
  if (!list || list.length !== track.position.length) {
    list = track.position.map((_, i) => wayDirection(track, i));
    kDirections.set(track, list);
  }
  return list[pose];
}

/// Every stretch of the way of the active run is turned into the plane of the paper.
function unrolled(view: View): Projection {
  return {
    title: "Extended elevation", axes: ["along the way (m)", "above the start (m)"], tracks: [view.active.value],
    isUnrolled: true,
    flat: (track, p, pose) => {
      const at = track.position[pose];
      if (!at) return [0, p[2]];
      const d = directionOf(track, pose);
      return [track.chainage_m[pose] + (p[0] - at[0]) * d[0] + (p[1] - at[1]) * d[1], p[2]];
    },
    directions: (track, pose) => [directionOf(track, pose) ?? [1, 0, 0], [0, 0, 1]],
  };
}
