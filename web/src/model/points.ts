// Clouds of points, and which colour a point gets.

import { sequential, themed } from "../base/colours";
import { decodeBytes, type Cloud } from "./data";
import { number } from "../base/format";
import type { Vec3, WorldMap } from "../base/geometry";
import type { Track } from "./track";

export interface Points {
  xyz: Float32Array; // x y z x y z ..., in the world that the page shows
  rgb: Uint8Array | null;
}

/// A step through `count` numbers, round and round, that meets each once and spreads the first ones over all.
function spreadingStep(count: number): number {
  const divisor = (a: number, b: number): number => (b === 0 ? a : divisor(b, a % b));
  let step = Math.max(1, Math.round(0.6180339887 * count));
  while (divisor(step, count) > 1) ++step;
  return step;
}

/// The first points of the result are spread over all, whatever the order of the cloud.
export function makePoints(cloud: Cloud, map: WorldMap): Points {
  const steps = new Uint16Array(decodeBytes(cloud.xyz).buffer);
  const given = cloud.rgb ? decodeBytes(cloud.rgb) : null;
  const xyz = new Float32Array(steps.length), rgb = given ? new Uint8Array(given.length) : null;
  const count = Math.floor(steps.length / 3), step = spreadingStep(count);
  const origin = map.point([0, 0, 0]);
  const axes = [map.point([1, 0, 0]), map.point([0, 1, 0]), map.point([0, 0, 1])].map((p) => p.map((v, k) => v - origin[k]));
  for (let i = 0, from = 0; i < count; ++i, from = (from + step) % count) {
    const x = cloud.low_m[0] + cloud.step_m[0] * steps[3 * from];
    const y = cloud.low_m[1] + cloud.step_m[1] * steps[3 * from + 1];
    const z = cloud.low_m[2] + cloud.step_m[2] * steps[3 * from + 2];
    for (let k = 0; k < 3; ++k) {
      xyz[3 * i + k] = axes[0][k] * x + axes[1][k] * y + axes[2][k] * z + origin[k];
      if (rgb && given) rgb[3 * i + k] = given[3 * from + k];
    }
  }
  return { xyz, rgb };
}

export type PointColouring = "plain" | "height" | "distance" | "uncertainty" | "image";

/// Index of the pose nearest to each point, by a lattice of cells that hold the poses.
export function nearestPoses(xyz: Float32Array, positions: Vec3[]): Int32Array {
  const nearest = new Int32Array(xyz.length / 3).fill(-1);
  if (positions.length === 0) return nearest;
  const kCell_m = 4;
  const key = (x: number, y: number, z: number) => (x + 4096) * 67108864 + (y + 4096) * 8192 + (z + 4096);
  const cell = (v: number) => Math.floor(v / kCell_m);
  const cells = new Map<number, number[]>();
  const every = Math.max(1, Math.floor(positions.length / 3000));
  for (let i = 0; i < positions.length; i += every) {
    const k = key(cell(positions[i][0]), cell(positions[i][1]), cell(positions[i][2]));
    const list = cells.get(k);
    if (list) list.push(i);
    else cells.set(k, [i]);
  }
  for (let n = 0; n < nearest.length; ++n) {
    const x = xyz[3 * n], y = xyz[3 * n + 1], z = xyz[3 * n + 2];
    let best = Infinity;
    for (let reach = 1; reach <= 4 && best > (reach * kCell_m) ** 2; reach *= 2) {
      for (let a = -reach; a <= reach; ++a) for (let b = -reach; b <= reach; ++b) for (let c = -reach; c <= reach; ++c) {
        for (const i of cells.get(key(cell(x) + a, cell(y) + b, cell(z) + c)) ?? []) {
          const p = positions[i];
          const d = (p[0] - x) ** 2 + (p[1] - y) ** 2 + (p[2] - z) ** 2;
          if (d < best) {
            best = d;
            nearest[n] = i;
          }
        }
      }
    }
  }
  return nearest;
}

export interface PointColours {
  title: string;
  low: string;
  high: string;
  rgb: Uint8Array | null; // of each point; null for one colour
}

function spread(values: Float32Array): [number, number] {
  // A sample is enough, since the first points are spread over all.
  const sorted = Float32Array.from(values.subarray(0, 50_000).filter((v) => Number.isFinite(v))).sort();
  if (sorted.length === 0) return [0, 1];
  // Single points far off would leave one colour for all others.
  const low = sorted[Math.floor(0.01 * (sorted.length - 1))];
  const high = sorted[Math.ceil(0.99 * (sorted.length - 1))];
  return [low, high > low ? high : low + 1];
}

function byValue(title: string, values: Float32Array): PointColours {
  const [low, high] = spread(values);
  const rgb = new Uint8Array(3 * values.length);
  const table = Array.from({ length: 256 }, (_, i) => sequential(i / 255));
  for (let i = 0; i < values.length; ++i) {
    const share = (values[i] - low) / (high - low);
    const colour = Number.isFinite(share) ? table[Math.round(255 * Math.min(1, Math.max(0, share)))] : [128, 128, 128];
    rgb.set(colour, 3 * i);
  }
  return { title, low: `${number(low, 3)} m`, high: `${number(high, 3)} m`, rgb };
}

const kKept = new WeakMap<Points, Map<string, PointColours>>();

/// Colours of all points of a cloud; worked out once for each track and theme.
export function pointColours(points: Points, track: Track, colouring: PointColouring): PointColours {
  const key = `${colouring} ${track.kind} ${themed("ground")}`;
  const kept = kKept.get(points) ?? new Map<string, PointColours>();
  kKept.set(points, kept);
  const found = kept.get(key) ?? work(points, track, colouring);
  kept.set(key, found);
  return found;
}

function work({ xyz, rgb }: Points, track: Track, colouring: PointColouring): PointColours {
  const count = xyz.length / 3;
  if (colouring === "image" && rgb) return { title: "Colour of the images", low: "", high: "", rgb };
  if (colouring === "height") return byValue("Height above the start", Float32Array.from({ length: count }, (_, i) => xyz[3 * i + 2]));
  if (colouring === "distance" || colouring === "uncertainty") {
    const nearest = nearestPoses(xyz, track.position);
    if (colouring === "uncertainty") {
      return byValue("Uncertainty of the nearest pose, one sigma",
        Float32Array.from({ length: count }, (_, i) => (nearest[i] < 0 ? NaN : track.positionSigma_m[nearest[i]] ?? NaN)));
    }
    return byValue("Distance from the way", Float32Array.from({ length: count }, (_, i) => {
      const p = track.position[nearest[i]];
      return p ? Math.hypot(xyz[3 * i] - p[0], xyz[3 * i + 1] - p[1], xyz[3 * i + 2] - p[2]) : NaN;
    }));
  }
  return { title: "", low: "", high: "", rgb: null };
}

/// The colour of all points where they have no colours.
export function plainColour(): [number, number, number] {
  const hex = parseInt(themed("landmark").slice(1), 16);
  return [hex >> 16, (hex >> 8) & 255, hex & 255];
}
