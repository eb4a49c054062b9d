// Which colour a pose gets.

import { sequential } from "../base/colours";
import { clock, number } from "../base/format";
import type { Track } from "./track";

export type Colouring = "time" | "heading" | "depth" | "error";

interface Kind {
  value: Colouring;
  text: string;
  title: string;
  values: (track: Track) => (number | null)[];
  format: (value: number) => string;
}

const kKinds: Kind[] = [
  { value: "time", text: "Time", title: "Time since the start", values: (t) => t.t_s, format: (v) => clock(v) },
  {
    value: "heading", text: "Heading σ", title: "Uncertainty of the heading, one sigma",
    values: (t) => t.headingSigma_deg, format: (v) => `${number(v, 2)}°`,
  },
  { value: "depth", text: "Depth", title: "Depth below the start", values: (t) => t.depth_m, format: (v) => `${number(v, 3)} m` },
  {
    value: "error", text: "Error", title: "Position error against the reference",
    values: (t) => t.error_m, format: (v) => `${number(v, 2)} m`,
  },
];

/// Error only where there is a reference; the rest every run has, if not yet.
export function available(tracks: Track[]): { value: Colouring; text: string }[] {
  return kKinds.filter(({ value }) => value !== "error" || tracks.some((track) => track.run.evaluation));
}

export interface ColourScale {
  title: string;
  low: string;
  high: string;
  colours: ([number, number, number] | null)[]; // of each pose
  text: (pose: number) => string;
}

export function colourScale(track: Track, colouring: Colouring): ColourScale {
  const kind = kKinds.find((k) => k.value === colouring) ?? kKinds[0];
  const values = kind.values(track);
  let low = Infinity;
  let high = -Infinity;
  for (const v of values) {
    if (v === null) continue;
    low = Math.min(low, v);
    high = Math.max(high, v);
  }
  const span = high > low ? high - low : 1;
  const format = (v: number | null) => (v === null || !Number.isFinite(v) ? "–" : kind.format(v));
  return {
    title: kind.title,
    low: format(low),
    high: format(high),
    colours: values.map((v) => (v === null ? null : sequential((v - low) / span))),
    text: (pose) => format(values[pose] ?? null),
  };
}
