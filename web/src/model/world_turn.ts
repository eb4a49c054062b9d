// A run that goes on counts heading from its first pose until north is found; then what is shown turns to north.

import type { Table } from "./data";
import { aboutVertical, multiply, rotate, type Quat, type Vec3 } from "../base/geometry";

type Numbers = Record<string, number | null>;

const kPosition = ["p_x [m]", "p_y [m]", "p_z [m]"];
const kRotation = ["q_w", "q_x", "q_y", "q_z"];

/// Turns position and rotation of one state about the vertical; a state without a pose stays as it is.
export function turnNumbers(numbers: Numbers, angle_rad: number): void {
  const turn = aboutVertical(angle_rad);
  const p = kPosition.map((name) => numbers[name] ?? null);
  const q = kRotation.map((name) => numbers[name] ?? null);
  if (p.some((v) => v === null) || q.some((v) => v === null)) return;
  rotate(turn, p as Vec3).forEach((v, i) => (numbers[kPosition[i]] = v));
  multiply(turn, q as Quat).forEach((v, i) => (numbers[kRotation[i]] = v));
}

export function turnRows(states: Table, angle_rad: number): void {
  const names = [...kPosition, ...kRotation];
  for (let row = 0; row < states.t_s.length; ++row) {
    const numbers: Numbers = Object.fromEntries(names.map((name) => [name, states.numbers[name][row]]));
    turnNumbers(numbers, angle_rad);
    for (const name of names) states.numbers[name][row] = numbers[name];
  }
}

/// Points x y z x y z ...
export function turnPoints(points: ArrayLike<number>, angle_rad: number): number[] {
  const turn = aboutVertical(angle_rad);
  const turned: number[] = [];
  for (let i = 0; i + 2 < points.length; i += 3) turned.push(...rotate(turn, [points[i], points[i + 1], points[i + 2]]));
  return turned;
}
