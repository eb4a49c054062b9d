// Puts the parts of the page together.

import { append, button, element, section } from "./base/dom";
import { fileName } from "./base/download";
import { findingsList, summaryTiles } from "./panels/summary";
import { kComparisonPlots } from "./plots/comparison_plots";
import { mapSection } from "./panels/map_section";
import { kMagnetometerPlots, kPlots } from "./plots/plots";
import { plotCard } from "./plots/plot";
import { sphereCard } from "./plots/sphere_view";
import { statusCard } from "./plots/status_strip";
import { comparisonTable, evaluationTable } from "./panels/tables";
import { trajectorySection } from "./trajectory_section";
import type { Run } from "./model/data";
import type { View } from "./model/view";

const kSources = {
  run: "causal trajectory (trajectory.tum)", refined: "refined trajectory (trajectory_refined.tum)",
  map: "trajectory in the map (keyframes_map.tum)",
};

export function head(view: View): HTMLElement {
  const name = element("h1");
  const from = element("p", "from");
  view.active.watch(({ run, kind }) => {
    name.textContent = run.name;
    const rig = run.summary.rig;
    const cameras = rig?.cameras?.length ?? 0;
    const parts = [kSources[kind],
      run.summary.data, cameras ? `${cameras} camera${cameras > 1 ? "s" : ""} at ${rig?.camera_rate_hz} Hz` : null,
      rig?.imu_rate_hz ? `IMU at ${rig.imu_rate_hz} Hz` : null, run.summary.program];
    from.textContent = parts.filter(Boolean).join(" · ");
    document.title = `${run.name} – Lodeline`;
  });
  const node = element("header", "head", element("p", "mark", "Lodeline"), name, from);
  if (view.tracks.length > 1) node.append(runSelect(view));
  return node;
}

function runSelect(view: View): HTMLElement {
  const select = element("select");
  view.tracks.forEach((track, i) => select.append(new Option(track.run.name, String(i))));
  select.addEventListener("change", () => view.active.set(view.tracks[Number(select.value)]));
  view.active.watch((track) => (select.value = String(view.tracks.indexOf(track))));
  return element("label", "run-select", "Run ", select);
}

function plots(view: View): HTMLElement {
  return section("plots", "Over time",
    element("p", "note screen", "Drag to zoom in, double-click to zoom out, click to select a pose; the figures of all plots follow the pointer."),
    element("div", "grid",
      statusCard(view, "status", "Status", [{ name: "images", column: "status" }, { name: "magnetometer", column: "magnetometer" }]),
      ...kPlots.map((spec) => plotCard(view, spec.make))));
}

function comparison(view: View): HTMLElement {
  return section("comparison", "Comparison", comparisonTable(view),
    element("div", "grid", ...kComparisonPlots.map((make) => plotCard(view, make))));
}

function magnetometer(view: View): HTMLElement | null {
  const has = ({ run }: { run: Run }) => run.magnetometer !== null || (run.states.numbers["field_x [T]"] ?? []).some((v) => v !== null);
  if (!view.tracks.some(has)) return null;
  const cards = kMagnetometerPlots.map((spec) => plotCard(view, spec));
  const sphere = view.tracks.some((t) => t.run.magnetometer) ? sphereCard(view) : null;
  return section("magnetometer", "Magnetometer", element("div", "grid", sphere, ...cards));
}

function configuration(view: View): HTMLElement {
  const text = element("pre");
  view.active.watch(({ run }) => (text.textContent = run.config));
  const save = button("config.yaml", "Download the settings; `lodeline run -c` takes them", () => {
    const link = element("a");
    link.href = URL.createObjectURL(new Blob([text.textContent ?? ""], { type: "text/yaml" }));
    link.download = fileName(view.active.value.run.name, "config.yaml");
    link.click();
  });
  const details = element("details", "", element("summary", "", "Show all settings that were in effect"), text);
  return section("configuration", "Configuration", element("div", "card", element("div", "tools", save), details));
}

/// What the page leaves out, in words.
function contents(view: View): HTMLElement {
  const node = element("p", "note");
  view.active.watch(({ run }) => {
    const { states, landmarks, pictures } = run;
    const shown = landmarks.xyz.length ? Math.floor((landmarks.xyz.length * 3) / 4 / 6) : 0;
    const rows = states.t_s.length < states.total
      ? `${states.t_s.length} of ${states.total} states (each ${states.stride}th, and those where a status changes)`
      : `all ${states.total} states`;
    node.textContent = `This page holds ${rows}, ${shown < landmarks.total ? `${shown} of ` : "all "}${landmarks.total} landmarks and ` +
      `${pictures.length} pictures; downloads give what the page holds. The run's folder has everything. ` +
      "Time counts from the first state.";
  });
  return node;
}

export function assemble(page: Element, view: View): void {
  const several = view.tracks.length > 1;
  append(page, head(view), summaryTiles(view),
    section("findings", "What to know about the data", findingsList(view)),
    trajectorySection(view),
    mapSection(view),
    several ? comparison(view) : null,
    view.tracks.some((t) => t.run.evaluation) ? section("evaluation", "Against the reference", evaluationTable(view)) : null,
    plots(view), magnetometer(view), configuration(view),
    element("footer", "", contents(view)));
}
