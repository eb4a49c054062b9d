// What is looked at: shared by all parts of the page.

import { nearestIndex, type Background } from "./data";
import { Signal } from "../base/signal";
import type { Colouring } from "./colouring";
import type { PointColouring } from "./points";
import type { Kind, Track } from "./track";

export interface Shown {
  landmarks: boolean;
  walls: boolean;
  reference: boolean;
  pictures: boolean;
  loops: boolean;
  others: boolean; // solutions of the same run
  stations: boolean;
  background: boolean;
}

/// Dives that were mapped together lie in one world there alone.
function areOneCave(solutions: Track[][]): boolean {
  return solutions.length > 1 && solutions.every((list) => list.some((t) => t.kind === "map")) &&
    solutions.some(([{ run }]) => run.map?.loops.some((loop) => loop.old_t_s === null));
}

export class View {
  tracks: Track[]; // one a run
  readonly active: Signal<Track>;
  readonly time: Signal<number>; // s since the start of the active run
  readonly colouring = new Signal<Colouring>("time");
  readonly pointColouring = new Signal<PointColouring>("plain");
  readonly ellipses = new Signal<number>(0); // times one sigma; 0 for none
  readonly mark = new Signal<number | null>(null); // s; from there to the selected pose is measured
  readonly shown = new Signal<Shown>({ landmarks: true, walls: true, reference: true, pictures: true, loops: true, others: true,
    stations: true, background: true });

  /// `solutions`: of each run, that first which is shown first.
  constructor(readonly solutions: Track[][], readonly background: Background | null = null) {
    this.tracks = solutions.map((list) => (areOneCave(solutions) ? list.find((t) => t.kind === "map") : null) ?? list[0]);
    this.active = new Signal(this.tracks[0]);
    this.time = new Signal(this.tracks[0].t_s[0] ?? 0);
  }

  /// Kinds that some run has, in the order of their precision.
  kinds(): Kind[] {
    return (["run", "refined", "map"] as Kind[]).filter((kind) => this.solutions.some((list) => list.some((t) => t.kind === kind)));
  }

  /// Shows this solution of every run that has it.
  showKind(kind: Kind): void {
    const index = this.tracks.indexOf(this.active.value);
    this.tracks = this.solutions.map((list) => list.find((t) => t.kind === kind) ?? list[0]);
    this.active.set(this.tracks[index]);
  }

  /// Other solutions of the active run in the same world.
  others(): Track[] {
    const active = this.active.value;
    const list = this.solutions.find((solutions) => solutions.includes(active)) ?? [];
    if (active.kind === "map" && active.inMap.length === 0) return []; // another dive places this one
    return list.filter((t) => t !== active && t.kind !== "map");
  }

  /// Index of the selected pose in the active track.
  pose(): number {
    return nearestIndex(this.active.value.t_s, this.time.value);
  }
}
