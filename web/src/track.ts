// The poses of a run, worked out once for all views.

import { decodeFloats, nearestIndex, type Run } from "./data";
import { bearing, rotate, WorldMap, type Quat, type Vec3 } from "./geometry";

const kDegrees = 180 / Math.PI;

/// One pose for every row of the states that has a position.
export interface Track {
  run: Run;
  row: number[]; // of the states
  t_s: number[];
  position: Vec3[]; // in the world that the page shows
  view: Vec3[]; // where the first camera looks
  heading_deg: (number | null)[]; // in the run's own world
  depth_m: number[]; // below the start
  headingSigma_deg: (number | null)[];
  positionSigma_m: (number | null)[];
  error_m: (number | null)[];
  map: WorldMap;
  inMap: Vec3[]; // the way in the map of the run, closed by loops, in the world that the page shows
  mapTurned_rad: number; // while a run goes on: the turn of its odometry in the map, as inMap shows it
  landmarks: Float32Array; // x y z x y z ..., in the world that the page shows
}

export function makeTrack(run: Run): Track {
  const map = new WorldMap(run);
  const track: Track = {
    run, map, inMap: mapPath(run, map), mapTurned_rad: 0, row: [], t_s: [], position: [], view: [], heading_deg: [], depth_m: [], headingSigma_deg: [],
    positionSigma_m: [], error_m: [], landmarks: mapped(decodeFloats(run.landmarks.xyz), map),
  };
  refill(track);
  return track;
}

/// Works all poses out again, after the states have changed.
export function refill(track: Track): void {
  for (const column of [track.row, track.t_s, track.position, track.view, track.heading_deg, track.depth_m,
    track.headingSigma_deg, track.positionSigma_m, track.error_m]) column.length = 0;
  for (let row = 0; row < track.run.states.t_s.length; ++row) appendPose(track, row);
}

/// Takes a row of the states along, where it has a position.
export function appendPose(track: Track, row: number): void {
  const { map } = track;
  const axis = (track.run.summary.rig?.camera_axis_B ?? [1, 0, 0]) as Vec3;
  const n = track.run.states.numbers;
  const x = n["p_x [m]"][row];
  if (x === null) return;
  const p: Vec3 = [x, n["p_y [m]"][row] ?? 0, n["p_z [m]"][row] ?? 0];
  const q: Quat = [n["q_w"][row] ?? 1, n["q_x"][row] ?? 0, n["q_y"][row] ?? 0, n["q_z"][row] ?? 0];
  const view = rotate(q, axis);
  const sigma = n["sigma_heading [rad]"]?.[row] ?? n["sigma_theta_z [rad]"]?.[row] ?? null;
  track.row.push(row);
  track.t_s.push(track.run.states.t_s[row]);
  track.position.push(map.point(p));
  track.view.push(map.direction(view));
  track.heading_deg.push(bearing(view));
  track.depth_m.push(-p[2]);
  track.headingSigma_deg.push(sigma === null ? null : sigma * kDegrees);
  track.positionSigma_m.push(positionSigma(n, row));
  track.error_m.push(errorAt(track.run, track.run.states.t_s[row]));
}

function positionSigma(n: Record<string, (number | null)[]>, row: number): number | null {
  const s = ["x", "y", "z"].map((axis) => n[`sigma_p_${axis} [m]`]?.[row] ?? null);
  return s.some((v) => v === null) ? null : Math.hypot(...(s as number[]));
}

function errorAt(run: Run, t: number): number | null {
  const errors = run.evaluation?.errors;
  if (!errors || errors.t_s.length === 0) return null;
  const i = nearestIndex(errors.t_s, t);
  // Further away than a few frames there was no reference to compare with.
  return Math.abs(errors.t_s[i] - t) < 1 ? errors.numbers["position [m]"][i] : null;
}

function mapPath(run: Run, map: WorldMap): Vec3[] {
  const path = run.map?.path;
  return path ? path.x.map((x, i) => map.point([x, path.y[i], path.z[i]])) : [];
}

/// Ends of the loops on a track; both are the same where the old keyframe is of another dive.
export function loopEnds(track: Track): [Vec3, Vec3][] {
  if (track.t_s.length === 0) return [];
  const at = (t: number) => track.position[nearestIndex(track.t_s, t)];
  return (track.run.map?.loops ?? []).map((loop) => [at(loop.old_t_s ?? loop.new_t_s), at(loop.new_t_s)]);
}

function mapped(xyz: Float32Array, map: WorldMap): Float32Array {
  const result = new Float32Array(xyz.length);
  for (let i = 0; i + 2 < xyz.length; i += 3) result.set(map.point([xyz[i], xyz[i + 1], xyz[i + 2]]), i);
  return result;
}

/// Middle of all poses, half of their greatest extent along an axis, and the radius of a ball around them.
export function extent(tracks: Track[]): { middle: Vec3; radius: number; reach: number } {
  const low: Vec3 = [Infinity, Infinity, Infinity];
  const high: Vec3 = [-Infinity, -Infinity, -Infinity];
  for (const track of tracks) {
    for (const p of track.position) {
      for (let k = 0; k < 3; ++k) {
        low[k] = Math.min(low[k], p[k]);
        high[k] = Math.max(high[k], p[k]);
      }
    }
  }
  if (low[0] > high[0]) return { middle: [0, 0, 0], radius: 1, reach: 1 };
  const middle = low.map((l, k) => (l + high[k]) / 2) as Vec3;
  const half = low.map((l, k) => (high[k] - l) / 2);
  return { middle, radius: Math.max(0.5, ...half), reach: Math.max(0.5, Math.hypot(...half)) };
}
