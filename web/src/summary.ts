// The figures of a run at a glance, and what was wrong with its data.

import { element } from "./dom";
import { alignmentName, duration, number } from "./format";
import type { Finding, Run } from "./data";
import type { View } from "./view";

interface Tile {
  name: string;
  value: string;
  detail: string;
}

function tiles(run: Run): Tile[] {
  const s = run.summary;
  const list: Tile[] = [
    { name: "Path", value: `${number(s.path_m)} m`, detail: `in ${duration(s.duration_s ?? 0)}` },
    {
      name: "Completion", value: `${number(100 * (s.completion ?? 0), 3)} %`,
      detail: `${s.frames_with_pose ?? 0} of ${s.frames ?? 0} frames`,
    },
    {
      name: "Heading, one sigma", value: `${number((180 / Math.PI) * (s.heading?.sigma_rad ?? NaN), 2)}°`,
      detail: `from ${s.heading?.reference ?? "the first heading"}, at the end`,
    },
    {
      name: "Reprojection", value: `${number(s.mean_reprojection_rms_px, 2)} px`,
      detail: `RMS; ${number(s.mean_tracks, 3)} tracks a frame`,
    },
    {
      name: "Speed", value: `${number(s.real_time_factor, 2)} ×`,
      detail: `real time; ${number(s.core_ms_per_frame?.total, 3)} core-ms a frame`,
    },
  ];
  const figures = run.evaluation?.figures;
  if (figures) {
    list.splice(2, 0, {
      name: "Position error", value: `${number(figures.absolute.position_m.rmse)} m`,
      detail: figures.alignment.type === "none" ? "RMSE, not aligned" : `RMSE after ${alignmentName(figures.alignment.type)} alignment`,
    });
  }
  return list;
}

export function summaryTiles(view: View): HTMLElement {
  const node = element("div", "tiles");
  view.active.watch(({ run }) => {
    node.replaceChildren(...tiles(run).map(({ name, value, detail }) =>
      element("div", "tile", element("span", "name", name), element("strong", "", value), element("span", "detail", detail))));
  });
  return node;
}

function findingLine(finding: Finding): HTMLElement {
  const badge = element("span", `badge ${finding.severity}`, finding.severity);
  const times = finding.count > 1 ? element("span", "count", `${finding.count} times`) : null;
  return element("li", "", badge, element("span", "message", finding.message), times);
}

export function findingsList(view: View): HTMLElement {
  const list = element("ul", "findings");
  view.active.watch(({ run }) => {
    const lines = (run.summary.findings ?? []).map(findingLine);
    if (run.summary.interrupted) {
      lines.unshift(findingLine({ severity: "warning", kind: "interrupted", count: 1,
        message: "The run was ended by hand before the recording was; what follows covers what was read." }));
    }
    if (run.summary.do_not_trust) {
      lines.unshift(findingLine({ severity: "serious", kind: "do_not_trust", count: 1,
        message: `The result is not to be trusted: ${run.summary.do_not_trust}.` }));
    }
    list.replaceChildren(...(lines.length ? lines : [element("li", "", "Nothing was found wrong with the data.")]));
  });
  return list;
}
