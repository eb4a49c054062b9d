// The poses of a run, worked out once for all views.

import { nearestIndex, type Run, type Table } from "./data";
import { bearing, rotate, WorldMap, type Quat, type Vec3 } from "../base/geometry";
import { makePoints, type Points } from "./points";

const kDegrees = 180 / Math.PI;
const kMovement_m = 0.25;
/// The last pose from which the length of the way was counted on.
const kAnchors = new WeakMap<Track, number>();

/// By which method a trajectory came about.
export type Kind = "refined" | "run" | "map";

/// One pose for every row of the states that has a position.
export interface Track {
  run: Run;
  kind: Kind;
  states: Table;
  row: number[]; // of the states
  t_s: number[];
  position: Vec3[]; // in the world that the page shows
  view: Vec3[]; // where the first camera looks
  heading_deg: (number | null)[]; // in the run's own world
  depth_m: number[]; // below the start
  chainage_m: number[]; // along the way from the start, smaller movements left out
  headingSigma_deg: (number | null)[];
  positionSigma_m: (number | null)[];
  covariance_m2: (number[] | null)[]; // xx xy xz yy yz zz, in the world that the page shows
  error_m: (number | null)[];
  map: WorldMap;
  inMap: Vec3[]; // the way in the map of the run, closed by loops, in the world that the page shows
  mapTurned_rad: number; // while a run goes on: the turn of its odometry in the map, as inMap shows it
  landmarks: Points;
  walls: Points | null;
}

function emptyTrack(run: Run, kind: Kind, states: Table, map: WorldMap, landmarks: Points, walls: Points | null): Track {
  const track: Track = {
    run, kind, states, map, inMap: mapPath(run, map), mapTurned_rad: 0, row: [], t_s: [], position: [], view: [], heading_deg: [],
    depth_m: [], chainage_m: [], headingSigma_deg: [], positionSigma_m: [], covariance_m2: [], error_m: [], landmarks, walls,
  };
  refill(track);
  return track;
}

/// All solutions of a run, that first which the page shows first.
export function makeTracks(run: Run): Track[] {
  const map = new WorldMap(run);
  const landmarks = makePoints(run.landmarks, map);
  const walls = run.walls && makePoints(run.walls, map);
  const first = emptyTrack(run, run.is_refined ? "refined" : "run", run.states, map, landmarks, walls);
  return [first, ...run.others.map(({ kind, states }) => emptyTrack(run, kind, states, map, landmarks, walls))];
}

/// Works all poses out again, after the states have changed.
export function refill(track: Track): void {
  for (const column of [track.row, track.t_s, track.position, track.view, track.heading_deg, track.depth_m, track.chainage_m,
    track.headingSigma_deg, track.positionSigma_m, track.covariance_m2, track.error_m]) column.length = 0;
  kAnchors.set(track, 0);
  for (let row = 0; row < track.states.t_s.length; ++row) appendPose(track, row);
}

/// Takes a row of the states along, where it has a position.
export function appendPose(track: Track, row: number): void {
  const { map } = track;
  const axis = (track.run.summary.rig?.camera_axis_B ?? [1, 0, 0]) as Vec3;
  const n = track.states.numbers;
  const x = n["p_x [m]"][row];
  if (x === null) return;
  const p: Vec3 = [x, n["p_y [m]"][row] ?? 0, n["p_z [m]"][row] ?? 0];
  const q: Quat = [n["q_w"][row] ?? 1, n["q_x"][row] ?? 0, n["q_y"][row] ?? 0, n["q_z"][row] ?? 0];
  const view = rotate(q, axis);
  const sigma = n["sigma_heading [rad]"]?.[row] ?? n["sigma_theta_z [rad]"]?.[row] ?? null;
  track.row.push(row);
  track.t_s.push(track.states.t_s[row]);
  track.position.push(map.point(p));
  track.view.push(map.direction(view));
  track.heading_deg.push(bearing(view));
  track.depth_m.push(-p[2]);
  track.chainage_m.push(chainage(track));
  track.headingSigma_deg.push(sigma === null ? null : sigma * kDegrees);
  track.positionSigma_m.push(positionSigma(n, row));
  track.covariance_m2.push(covariance(n, row, map));
  track.error_m.push(track.states === track.run.states ? errorAt(track.run, track.states.t_s[row]) : null);
}

/// Length of the way up to the newest pose. It is counted from the last pose that lies so far away that the noise
/// of the poses does not lengthen the way.
function chainage(track: Track): number {
  const { position, chainage_m } = track;
  const last = position.length - 1;
  if (last === 0) return 0;
  const anchor = kAnchors.get(track) ?? 0;
  const moved = Math.hypot(...position[last].map((v, k) => v - position[anchor][k]));
  if (moved >= kMovement_m) kAnchors.set(track, last);
  return Math.max(chainage_m[last - 1], chainage_m[anchor] + moved);
}

function positionSigma(n: Table["numbers"], row: number): number | null {
  const s = ["x", "y", "z"].map((axis) => n[`sigma_p_${axis} [m]`]?.[row] ?? null);
  return s.some((v) => v === null) ? null : Math.hypot(...(s as number[]));
}

/// R C R^T, with the rotation and the scale of the alignment.
function covariance(n: Table["numbers"], row: number, map: WorldMap): number[] | null {
  const c = ["00", "01", "02", "11", "12", "22"].map((at) => n[`cov_pose_${at}`]?.[row] ?? null);
  if (c.some((v) => v === null)) return null;
  const [xx, xy, xz, yy, yz, zz] = c as number[];
  const columns = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map((v) => map.direction(v as Vec3));
  const rows = [0, 1, 2].map((k) => map.direction(columns.map((v) => v[k]) as Vec3));
  const s = map.scale ** 2;
  return [rows[0][0], rows[0][1], rows[0][2], rows[1][1], rows[1][2], rows[2][2]].map((v) => s * v);
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

export function poseAt(track: Track, t_s: number): number {
  return nearestIndex(track.t_s, t_s);
}

/// Ends of the loops on a track; both are the same where the old keyframe is of another dive.
export function loopEnds(track: Track): [Vec3, Vec3][] {
  if (track.t_s.length === 0) return [];
  const at = (t: number) => track.position[poseAt(track, t)];
  return (track.run.map?.loops ?? []).map((loop) => [at(loop.old_t_s ?? loop.new_t_s), at(loop.new_t_s)]);
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
