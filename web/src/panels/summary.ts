// The figures of a run at a glance, and what was wrong with its data.

import { element } from "../base/dom";
import { alignmentName, duration, number } from "../base/format";
import type { Finding, Run, Summary } from "../model/data";
import type { View } from "../model/view";

interface Tile {
  name: string;
  value: string;
  detail: string;
}

/// How many images gave a pose, and how many poses came about otherwise.
function completionDetail(s: Summary): string {
  const inertial = s.frames_inertial ?? 0;
  const degraded = s.frames_degraded ?? 0;
  return [`${(s.frames_with_pose ?? 0) - inertial - degraded} of ${s.images_recorded ?? s.frames ?? 0} images`,
    inertial ? `${inertial} frames by inertial readings alone` : null,
    degraded ? `${degraded} degraded` : null].filter(Boolean).join("; ");
}

function tiles(run: Run): Tile[] {
  const s = run.summary;
  const list: Tile[] = [
    { name: "Path", value: `${number(s.path_m)} m`, detail: `in ${duration(s.duration_s ?? 0)}` },
    {
      name: "Completion", value: `${number(100 * (s.completion ?? 0), 3)} %`,
      detail: completionDetail(s),
    },
    {
      name: "Heading, one sigma", value: `${number((180 / Math.PI) * (s.heading?.sigma_rad ?? NaN), 2)}°`,
      detail: `from ${s.heading?.reference ?? "the first heading"}, at the end` +
        (s.heading?.north_found_after_s === undefined ? "" : `; north found after ${number(s.heading.north_found_after_s, 3)} s`),
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

const kClock = /\b(?:(\d+):)?(\d{1,2}):(\d{2}(?:\.\d+)?)(?![\d:])/g;

/// The text with every time (m:ss.s since the first frame) as a link to the pose of that moment.
function withTimeLinks(text: string, view: View, run: Run): (string | Node)[] {
  const offset_s = Number(BigInt(run.summary.first_frame_ns ?? run.origin_ns) - BigInt(run.origin_ns)) * 1e-9;
  const parts: (string | Node)[] = [];
  let end = 0;
  for (const match of text.matchAll(kClock)) {
    const [hours, minutes, seconds] = match.slice(1).map((digits) => Number(digits ?? 0));
    const link = element("a", "time-link", match[0]);
    link.href = "#trajectory";
    link.title = "Show the pose of this moment";
    link.addEventListener("click", () => view.time.set(3600 * hours + 60 * minutes + seconds + offset_s));
    parts.push(text.slice(end, match.index), link);
    end = match.index + match[0].length;
  }
  return [...parts, text.slice(end)];
}

function findingLine(finding: Finding, view: View, run: Run): HTMLElement {
  const badge = element("span", `badge ${finding.severity}`, finding.severity);
  const times = finding.count > 1 ? element("span", "count", `${finding.count} times`) : null;
  return element("li", "", badge, element("span", "message", ...withTimeLinks(finding.message, view, run)), times);
}

export function findingsList(view: View): HTMLElement {
  const list = element("ul", "findings");
  view.active.watch(({ run }) => {
    const lines = (run.summary.findings ?? []).map((finding) => findingLine(finding, view, run));
    if (run.summary.interrupted) {
      lines.unshift(findingLine({ severity: "warning", kind: "interrupted", count: 1,
        message: "The run was ended by hand before the recording was; what follows covers what was read." }, view, run));
    }
    if (run.summary.do_not_trust) {
      lines.unshift(findingLine({ severity: "serious", kind: "do_not_trust", count: 1,
        message: `The result is not to be trusted: ${run.summary.do_not_trust}.` }, view, run));
    }
    list.replaceChildren(...(lines.length ? lines : [element("li", "", "Nothing was found wrong with the data.")]));
  });
  return list;
}
