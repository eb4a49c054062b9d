// Rotations and the way a run looks in the world that the page shows.

import type { Run } from "../model/data";

export type Vec3 = [number, number, number];
export type Quat = [number, number, number, number]; // w x y z

export function rotate(q: Quat, v: Vec3): Vec3 {
  const [w, x, y, z] = q;
  const t: Vec3 = [
    2 * (y * v[2] - z * v[1]),
    2 * (z * v[0] - x * v[2]),
    2 * (x * v[1] - y * v[0]),
  ];
  return [
    v[0] + w * t[0] + y * t[2] - z * t[1],
    v[1] + w * t[1] + z * t[0] - x * t[2],
    v[2] + w * t[2] + x * t[1] - y * t[0],
  ];
}

export function multiply(a: Quat, b: Quat): Quat {
  const [w, x, y, z] = a;
  return [
    w * b[0] - x * b[1] - y * b[2] - z * b[3],
    w * b[1] + x * b[0] + y * b[3] - z * b[2],
    w * b[2] - x * b[3] + y * b[0] + z * b[1],
    w * b[3] + x * b[2] - y * b[1] + z * b[0],
  ];
}

/// A turn about the vertical, counter-clockwise seen from above.
export function aboutVertical(angle_rad: number): Quat {
  return [Math.cos(angle_rad / 2), 0, 0, Math.sin(angle_rad / 2)];
}

/// Compass direction, degrees clockwise from the world's y axis; null where the vector is upright.
export function bearing(v: Vec3): number | null {
  if (Math.hypot(v[0], v[1]) < 1e-3) return null;
  const degrees = (Math.atan2(v[0], v[1]) * 180) / Math.PI;
  return degrees < 0 ? degrees + 360 : degrees;
}

/// Takes the world of a run's estimate to that of its reference, or stays where there is none.
export class WorldMap {
  scale = 1;
  private q: Quat = [1, 0, 0, 0];
  private t: Vec3 = [0, 0, 0];

  constructor(run: Run) {
    const alignment = run.evaluation?.figures.alignment;
    if (!alignment) return;
    this.scale = alignment.scale;
    this.q = alignment.reference_from_estimate_quaternion_wxyz as Quat;
    this.t = alignment.reference_from_estimate_translation_m as Vec3;
  }

  point(p: Vec3): Vec3 {
    const r = rotate(this.q, p);
    return [this.scale * r[0] + this.t[0], this.scale * r[1] + this.t[1], this.scale * r[2] + this.t[2]];
  }

  get isIdentity(): boolean {
    return this.scale === 1 && this.q[0] === 1 && this.t.every((v) => v === 0);
  }

  direction(v: Vec3): Vec3 {
    return rotate(this.q, v);
  }
}
