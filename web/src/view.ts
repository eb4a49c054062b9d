// What is looked at: shared by all parts of the page.

import type { Track } from "./track";
import { nearestIndex } from "./data";
import { Signal } from "./signal";
import type { Colouring } from "./colouring";

export interface Shown {
  landmarks: boolean;
  reference: boolean;
  pictures: boolean;
  loops: boolean;
  map: boolean;
}

export class View {
  readonly active: Signal<Track>;
  readonly time: Signal<number>; // s since the start of the active run
  readonly colouring = new Signal<Colouring>("time");
  readonly shown = new Signal<Shown>({ landmarks: true, reference: true, pictures: true, loops: true, map: true });

  constructor(readonly tracks: Track[]) {
    this.active = new Signal(tracks[0]);
    this.time = new Signal(tracks[0].t_s[0] ?? 0);
  }

  /// Index of the selected pose in the active track.
  pose(): number {
    return nearestIndex(this.active.value.t_s, this.time.value);
  }
}
