// Several runs over the same time.

import { kKinds } from "../base/colours";
import { nearestIndex } from "../model/data";
import type { Vec3 } from "../base/geometry";
import type { PlotSpec, Series } from "./plot";
import { unwrapped } from "./plots";
import type { Track } from "../model/track";
import type { View } from "../model/view";

type Values = (number | null)[];

/// All runs on one axis of time: that of the active run where all recordings overlap, else each from its start.
interface Timeline {
  t_s: number[];
  isShared: boolean; // the same moments of the same recording
  /// Index of the pose of each run at each time; null where it has none near.
  pose: (number | null)[][];
}

function later_s(track: Track, other: Track): number {
  return Number(BigInt(track.run.origin_ns) - BigInt(other.run.origin_ns)) * 1e-9;
}

function medianStep(t_s: number[]): number {
  const steps = t_s.slice(1).map((t, i) => t - t_s[i]).sort((a, b) => a - b);
  return steps.length ? steps[steps.length >> 1] : 0;
}

function timelineOf(view: View): Timeline | null {
  const tracks = view.tracks.filter((track) => track.t_s.length > 0);
  if (tracks.length < 2 || view.active.value.t_s.length === 0) return null;
  const spans = tracks.map((track) => {
    const offset = later_s(track, view.active.value);
    return { offset, from: track.t_s[0] + offset, to: track.t_s[track.t_s.length - 1] + offset };
  });
  const isShared = Math.max(...spans.map((s) => s.from)) < Math.min(...spans.map((s) => s.to));
  const times = tracks.map((track, i) => (isShared ? track.t_s.map((t) => t + spans[i].offset) : track.t_s));
  // The same frame has the same stamp in every run, but for rounding.
  const sorted = times.flat().sort((a, b) => a - b);
  const t_s = sorted.filter((t, i) => i === 0 || t - sorted[i - 1] > 1e-4);
  const pose = times.map((own) => {
    const near_s = Math.max(0.02, 1.5 * medianStep(own));
    return t_s.map((t) => {
      const i = nearestIndex(own, t);
      return Math.abs(own[i] - t) <= near_s ? i : null;
    });
  });
  return { t_s, isShared, pose };
}

/// One timeline serves all plots.
const kTimelines = new WeakMap<Track, Timeline | null>();

function timeline(view: View): Timeline | null {
  const active = view.active.value;
  if (!kTimelines.has(active)) kTimelines.set(active, timelineOf(view));
  return kTimelines.get(active) ?? null;
}

function present(view: View): Track[] {
  return view.tracks.filter((track) => track.t_s.length > 0);
}

function colourOf(view: View, track: Track): string {
  return kKinds[view.tracks.indexOf(track) % kKinds.length];
}

function ofEach(view: View, values: (track: Track) => Values): Series[] {
  const { pose } = timeline(view)!;
  return present(view).map((track, i) => {
    const own = values(track);
    const drawn = pose[i].map((k) => (k === null ? null : own[k]));
    // Where runs agree, the first shows on both sides of the others.
    return { label: track.run.name, colour: colourOf(view, track), values: drawn, width: i === 0 ? 3 : 1.4 };
  });
}

/// What each further run makes of two poses at the same moment, its own and the first run's.
function againstFirst(view: View, value: (track: Track, i: number, first: Track, k: number) => number | null): Series[] {
  const { pose } = timeline(view)!;
  const [first, ...others] = present(view);
  return others.map((track, n) => ({
    label: track.run.name, colour: colourOf(view, track),
    values: pose[n + 1].map((i, row) => {
      const k = pose[0][row];
      return i === null || k === null ? null : value(track, i, first, k);
    }),
  }));
}

function hasSome(series: Series[]): boolean {
  return series.some(({ values }) => values.some((v) => v !== null));
}

function smallestTurn(degrees: number): number {
  return ((((degrees + 180) % 360) + 360) % 360) - 180;
}

/// Continued past 360 degrees as all others are, and no full turn away from the first.
function besideFirst(series: Series[]): Series[] {
  const start = ({ values }: Series) => values.find((v) => v !== null) ?? 0;
  return series.map((s) => {
    const turns = 360 * Math.round((start(s) - start(series[0])) / 360);
    return { ...s, values: s.values.map((v) => (v === null ? null : v - turns)) };
  });
}

function headings(view: View): PlotSpec | null {
  const line = timeline(view);
  return line && {
    id: "compare-heading", title: "Headings", unit: "°", axis: "degrees", t_s: line.t_s,
    series: besideFirst(ofEach(view, (track) => unwrapped(track.heading_deg))),
    note: "Each from its own north, or from the world's y axis where none is known.",
  };
}

function headingDifference(view: View): PlotSpec | null {
  const line = timeline(view);
  if (!line?.isShared) return null;
  const series = againstFirst(view, (track, i, first, k) => {
    const a = track.heading_deg[i];
    const b = first.heading_deg[k];
    return a === null || b === null ? null : smallestTurn(a - b);
  });
  return hasSome(series) ? {
    id: "compare-heading-difference", title: `Heading less that of ${present(view)[0].run.name}`, unit: "°", axis: "degrees",
    t_s: line.t_s, series, note: "A constant part is the difference of their norths; what changes is drift of one or the other.",
  } : null;
}

function depths(view: View): PlotSpec | null {
  const line = timeline(view);
  return line && {
    id: "compare-depth", title: "Depths below the start", unit: "m", t_s: line.t_s, downwards: true,
    series: ofEach(view, (track) => track.depth_m),
  };
}

function positionDifference(view: View): PlotSpec | null {
  const line = timeline(view);
  if (!line?.isShared) return null;
  const between = (a: Vec3, b: Vec3) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  const series = againstFirst(view, (track, i, first, k) => between(track.position[i], first.position[k]));
  const isAligned = present(view).every((track) => track.run.evaluation);
  return hasSome(series) ? {
    id: "compare-position-difference", title: `Distance from ${present(view)[0].run.name}`, unit: "m", t_s: line.t_s, series,
    note: isAligned ? "At the same moment, each aligned with the reference."
      : "At the same moment, as the maps above show them: each run in its own world.",
  } : null;
}

function positionErrors(view: View): PlotSpec | null {
  const line = timeline(view);
  if (!line) return null;
  const series = ofEach(view, (track) => track.error_m);
  return hasSome(series) ? { id: "compare-position-error", title: "Position errors against the reference", unit: "m", t_s: line.t_s, series } : null;
}

function headingSigmas(view: View): PlotSpec | null {
  const line = timeline(view);
  return line && {
    id: "compare-heading-sigma", title: "Heading uncertainties, one sigma", unit: "°", axis: "degrees", t_s: line.t_s,
    series: ofEach(view, (track) => track.headingSigma_deg),
  };
}

export const kComparisonPlots = [headings, headingDifference, depths, positionDifference, positionErrors, headingSigmas];
