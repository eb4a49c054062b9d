// Figures against the reference, and several runs side by side.

import { kKinds } from "../base/colours";
import { button, element, table } from "../base/dom";
import { saveCsv } from "../base/download";
import { alignmentName, duration, number } from "../base/format";
import { attitudeErrors, type Run } from "../model/data";
import type { View } from "../model/view";

export function evaluationTable(view: View): HTMLElement {
  const node = element("div", "card");
  view.active.watch(({ run }) => {
    const f = run.evaluation?.figures;
    node.hidden = !f;
    if (!f) return;
    const row = (name: string, s: { rmse: number; mean: number; median: number; max: number }, unit: string) =>
      [name, ...[s.rmse, s.mean, s.median, s.max].map((v) => `${number(v)}${unit}`)];
    const level = run.evaluation?.yaw_aligned;
    const attitude = attitudeErrors(run.evaluation!);
    const after = level ? ", turned about the vertical only" : "";
    const rows = [
      row("Position", f.absolute.position_m, " m"),
      ...(level ? [row(`Position${after}`, level.position_m, " m")] : []),
      row(`Rotation${after}`, attitude.rotation_deg, "°"),
      row(`Heading${after}`, attitude.yaw_deg, "°"),
      ...(f.relative ?? []).map((r) => row(`Over ${number(r.length_m)} m of path`, r.translation_percent, " %")),
    ];
    node.replaceChildren(
      element("p", "note", `Against ${f.reference.name}: ${f.association.pairs} pairs of poses, ${alignmentName(f.alignment.type)} alignment` +
        ` (scale ${f.alignment.scale.toFixed(4)}), ${number(f.reference.path_m)} m of path. ` +
        `At the end ${number(f.end_point.after_alignment_m)} m off, ${number(f.end_point.after_alignment_percent, 2)} % of the path; ` +
        `with equal starts ${number(f.end_point.from_equal_starts_percent, 2)} %.` +
        (level ? " Rotation and heading are told after turning about the vertical only: positions along a nearly straight way" +
          " leave the turn about it open." : "")),
      table(["", "RMSE", "mean", "median", "greatest"], rows));
  });
  return node;
}

const kComparison: { name: string; value: (run: Run) => number | null | undefined; text: (v: number) => string }[] = [
  { name: "Path (m)", value: (r) => r.summary.path_m, text: (v) => number(v, 4) },
  { name: "Duration", value: (r) => r.summary.duration_s, text: duration },
  { name: "Completion (%)", value: (r) => 100 * (r.summary.completion ?? NaN), text: (v) => number(v, 4) },
  { name: "Position RMSE (m)", value: (r) => r.evaluation?.figures.absolute.position_m.rmse, text: (v) => number(v) },
  { name: "Heading RMSE (°)", value: (r) => r.evaluation && attitudeErrors(r.evaluation).yaw_deg.rmse, text: (v) => number(v) },
  { name: "Heading σ at the end (°)", value: (r) => (180 / Math.PI) * (r.summary.heading?.sigma_rad ?? NaN), text: (v) => number(v) },
  { name: "Reprojection (px)", value: (r) => r.summary.mean_reprojection_rms_px, text: (v) => number(v) },
  { name: "Tracks a frame", value: (r) => r.summary.mean_tracks, text: (v) => number(v) },
  { name: "Landmarks", value: (r) => r.summary.landmarks, text: (v) => String(v) },
  { name: "Core-ms a frame", value: (r) => r.summary.core_ms_per_frame?.total, text: (v) => number(v) },
  { name: "× real time", value: (r) => r.summary.real_time_factor, text: (v) => number(v) },
];

/// One column a run; its name selects it.
export function comparisonTable(view: View): HTMLElement {
  const shown = kComparison.filter(({ value }) => view.tracks.some((t) => Number.isFinite(value(t.run) ?? NaN)));
  const cell = (v: number | null | undefined, text: (v: number) => string) =>
    v === null || v === undefined || !Number.isFinite(v) ? "–" : text(v);
  const rows = shown.map(({ name, value, text }) => [name, ...view.tracks.map((t) => cell(value(t.run), text))]);
  const names = view.tracks.map((track, i) => {
    const swatch = element("i");
    swatch.style.background = kKinds[i % kKinds.length];
    const name = button(track.run.name, "Look at this run", () => view.active.set(track));
    name.prepend(swatch);
    return name;
  });
  const node = table(["", ...names], rows);
  const save = () => saveCsv("comparison", [
    { name: "figure", values: shown.map((s) => `"${s.name}"`) },
    ...view.tracks.map((t) => ({ name: t.run.name, values: shown.map((s) => s.value(t.run) ?? null) })),
  ]);
  return element("div", "card", element("header", "", element("h3", "", "Figures side by side"),
    element("div", "tools", button("CSV", "Download this table", save))), node);
}
