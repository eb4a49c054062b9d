// Which plots there are, and what is in them.

import { kAxes, kKinds, themed } from "../base/colours";
import { column, type Table } from "../model/data";
import type { PlotSpec, Series } from "./plot";
import type { View } from "../model/view";

type Values = (number | null)[];

const kDegrees = 180 / Math.PI;

function scaled(values: Values, factor: number): Values {
  return values.map((v) => (v === null ? null : v * factor));
}

function plus(values: Values, other: Values, factor: number): Values {
  return values.map((v, i) => (v === null || other[i] === null ? null : v + factor * (other[i] as number)));
}

/// Curves of three axes with a band of one sigma each, where it is known.
function triad(table: Table, name: (axis: string) => string, factor: number, sigma?: (axis: string) => string) {
  const series: Series[] = [];
  const bands: PlotSpec["bands"] = [];
  ["x", "y", "z"].forEach((axis, k) => {
    const values = column(table, name(axis));
    if (values) series.push({ label: axis, values: scaled(values, factor), colour: kAxes[k] });
  });
  if (series.length === 0) return null;
  ["x", "y", "z"].forEach((axis, k) => {
    const s = sigma ? column(table, sigma(axis)) : null;
    if (!s || !series[k]) return;
    const first = series.length + 1;
    for (const sign of [1, -1]) {
      const edge = plus(series[k].values, scaled(s, factor), sign);
      series.push({ label: `${axis} ${sign > 0 ? "+" : "−"} σ`, values: edge, colour: "transparent", hidden: true });
    }
    bands!.push({ upper: first, lower: first + 1, colour: `${kAxes[k]}22` });
  });
  return { series, bands };
}

/// Degrees without jumps at north, as far as the curve is drawn.
export function unwrapped(values: Values): Values {
  let turns = 0;
  let last: number | null = null;
  return values.map((v) => {
    if (v === null) return null;
    if (last !== null && v + turns - last > 180) turns -= 360;
    else if (last !== null && v + turns - last < -180) turns += 360;
    last = v + turns;
    return last;
  });
}

function heading(view: View): PlotSpec | null {
  const track = view.active.value;
  if (track.t_s.length === 0) return null;
  const values = unwrapped(track.heading_deg);
  const colour = kKinds[0];
  const reference = track.run.summary.heading?.reference ?? "the first heading";
  return {
    id: "heading", title: `Heading from ${reference}`, unit: "°", axis: "degrees", t_s: track.t_s,
    series: [
      { label: "heading", values, colour },
      { label: "+ σ", values: plus(values, track.headingSigma_deg, 1), colour: "transparent", hidden: true },
      { label: "− σ", values: plus(values, track.headingSigma_deg, -1), colour: "transparent", hidden: true },
    ],
    bands: [{ upper: 2, lower: 3, colour: `${colour}33` }],
    note: track.run.summary.rig?.camera_axis_B
      ? "Where the first camera looks, clockwise; band: one sigma. Continued past 360°."
      : "Body x axis, clockwise; band: one sigma. Continued past 360°.",
  };
}

function uncertainty(view: View): PlotSpec | null {
  const track = view.active.value;
  return track.t_s.length === 0 ? null : {
    id: "heading-sigma", title: "Heading uncertainty, one sigma", unit: "°", axis: "degrees", t_s: track.t_s,
    series: [{ label: "σ heading", values: track.headingSigma_deg, colour: kKinds[0] }],
  };
}

function depth(view: View): PlotSpec | null {
  const track = view.active.value;
  return track.t_s.length === 0 ? null : {
    id: "depth", title: "Depth below the start", unit: "m", t_s: track.t_s, downwards: true,
    series: [{ label: "depth", values: track.depth_m, colour: kKinds[0] }],
  };
}

function positionSigma(view: View): PlotSpec | null {
  const track = view.active.value;
  const series: Series[] = [{ label: "σ position", values: track.positionSigma_m, colour: kKinds[0] }];
  if (track.error_m.some((v) => v !== null)) {
    series.push({ label: "error", values: track.error_m, colour: kKinds[1] });
  }
  return track.t_s.length === 0 ? null : {
    id: "position-sigma", title: series.length > 1 ? "Position: claimed and true error" : "Position uncertainty, one sigma",
    unit: "m", t_s: track.t_s, series,
  };
}

function ofStates(
  id: string, title: string, unit: string, name: (axis: string) => string, factor: number, sigma?: (axis: string) => string
): (view: View) => PlotSpec | null {
  return (view) => {
    const { states } = view.active.value.run;
    const curves = triad(states, name, factor, sigma);
    return curves && { id, title, unit, t_s: states.t_s, ...curves, note: sigma ? "Bands: one sigma." : undefined };
  };
}

function tracks(view: View): PlotSpec | null {
  const { states } = view.active.value.run;
  const followed = column(states, "tracks");
  const used = column(states, "landmarks");
  return followed && used && {
    id: "tracks", title: "Tracked points", unit: "", axis: "points", t_s: states.t_s,
    series: [
      { label: "tracks", values: followed, colour: kKinds[5] },
      { label: "of them landmarks", values: used, colour: kKinds[0] },
    ],
  };
}

function reprojection(view: View): PlotSpec | null {
  const { states } = view.active.value.run;
  const rms = column(states, "reprojection_rms [sigma]");
  return rms && {
    id: "reprojection", title: "Reprojection error, RMS", unit: "σ", axis: "standard deviations", t_s: states.t_s,
    series: [{ label: "RMS", values: rms, colour: kKinds[0] }],
    note: "In standard deviations of an observation; 1 is what the noise model expects.",
  };
}

function timings(view: View): PlotSpec | null {
  const table = view.active.value.run.timings;
  if (!table) return null;
  const of = (name: string) => scaled(table.numbers[name] ?? [], 1e3);
  return {
    id: "timings", title: "Time for a frame", unit: "ms", t_s: table.t_s,
    series: [
      { label: "whole (wall clock)", values: of("wall [s]"), colour: themed("faint"), width: 1 },
      { label: "front end (processor)", values: of("front_end [s]"), colour: kKinds[4] },
      { label: "estimator (processor)", values: of("estimator [s]"), colour: kKinds[0] },
    ],
  };
}

function yawError(view: View): PlotSpec | null {
  const errors = view.active.value.run.evaluation?.errors;
  return errors ? {
    id: "yaw-error", title: "Heading error against the reference", unit: "°", axis: "degrees", t_s: errors.t_s,
    series: [{ label: "error", values: errors.numbers["yaw [deg]"], colour: kKinds[1] }],
    note: view.active.value.run.evaluation?.yaw_aligned ? "After turning about the vertical only." : undefined,
  } : null;
}

type Make = (view: View) => PlotSpec | null;

export const kPlots: { id: string; make: Make }[] = [
  { id: "heading", make: heading },
  { id: "depth", make: depth },
  { id: "heading-sigma", make: uncertainty },
  { id: "position-sigma", make: positionSigma },
  { id: "yaw-error", make: yawError },
  {
    id: "velocity",
    make: ofStates("velocity", "Velocity in the world", "m/s", (a) => `v_${a} [m/s]`, 1, (a) => `sigma_v_${a} [m/s]`),
  },
  {
    id: "gyroscope-bias",
    make: ofStates("gyroscope-bias", "Gyroscope bias", "°/s", (a) => `b_g_${a} [rad/s]`, kDegrees, (a) => `sigma_b_g_${a} [rad/s]`),
  },
  {
    id: "accelerometer-bias",
    make: ofStates("accelerometer-bias", "Accelerometer bias", "m/s²", (a) => `b_a_${a} [m/s^2]`, 1, (a) => `sigma_b_a_${a} [m/s^2]`),
  },
  { id: "tracks", make: tracks },
  { id: "reprojection", make: reprojection },
  { id: "timings", make: timings },
];

export const kMagnetometerPlots: Make[] = [
  ofStates("magnetometer-offset", "Magnetometer offset", "µT", (a) => `offset_${a} [T]`, 1e6),
  ofStates("field", "Field in the world", "µT", (a) => `field_${a} [T]`, 1e6),
];
