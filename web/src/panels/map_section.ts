// The map of a run: loops, what became of all pairs that were compared, and control points.

import { element, section, table } from "../base/dom";
import { clock, number } from "../base/format";
import type { RunMap } from "../model/data";
import type { View } from "../model/view";

function moment(view: View, t_s: number): HTMLElement {
  const link = element("a", "time-link", clock(t_s, 1));
  link.href = "#trajectory";
  link.title = "Show the pose of this moment";
  link.addEventListener("click", () => view.time.set(t_s));
  return link;
}

function moments(view: View, times: number[], count: number): HTMLElement {
  const links = times.flatMap((t_s, i) => (i > 0 ? [", ", moment(view, t_s)] : [moment(view, t_s)]));
  return element("span", "", ...links, count > times.length ? ", …" : null);
}

/// Loops between keyframes of this dive, and with other dives.
function loopsText(map: RunMap): string {
  if (map.pairs === 0) return "No place came into view twice, so no pair of images was compared.";
  const accepted = map.outcomes.filter((o) => o.status === "accepted").reduce((sum, o) => sum + o.count, 0);
  const others = map.loops.filter((loop) => loop.old_t_s === null).length;
  const text = `${map.pairs} pairs of images were compared and ${accepted} accepted as loops`;
  return others ? `${text}, ${others} of those shown with other dives.` : `${text}.`;
}

function ledgerCard(view: View, map: RunMap): HTMLElement {
  const rows = map.outcomes.map((outcome) => [
    element("span", `badge ${outcome.status}`, outcome.status), String(outcome.count),
    outcome.reason || "–", moments(view, outcome.t_s, outcome.count)]);
  const card = element("div", "card ledger", element("header", "", element("h3", "", "Loops")), element("p", "note", loopsText(map)));
  if (rows.length) card.append(table(["Status", "Pairs", "Why it went no further", "At"], rows));
  return card;
}

const kMostMoments = 5;

/// Sightings of one point that are used together; each blunder for itself.
function groups(control: RunMap["control"]): RunMap["control"][] {
  const used = new Map<string, RunMap["control"]>();
  for (const point of control) if (!point.is_blunder) used.set(point.name, [...(used.get(point.name) ?? []), point]);
  return [...control.filter((point) => point.is_blunder).map((point) => [point]), ...used.values()];
}

function controlCard(view: View, map: RunMap): HTMLElement | null {
  if (map.control.length === 0) return null;
  const rows = groups(map.control).map((points) => [
    points[0].name, points[0].kind, String(points.length),
    number(Math.sqrt(points.reduce((sum, { error_m }) => sum + Math.hypot(...error_m) ** 2, 0) / points.length), 2),
    number(Math.max(...points.map((point) => point.chi_squared)), 2),
    moments(view, points.slice(0, kMostMoments).map((point) => point.t_s), points.length),
    points[0].is_blunder ? element("span", "badge warning", "blunder") : "used"]);
  return element("div", "card control", element("header", "", element("h3", "", "Tags and control points")),
    element("p", "note", "Residuals of the solved map. Above a chi squared of 16.3, an observation is a blunder."),
    table(["Point", "Kind", "Sightings", "Residual, RMS (m)", "Largest χ²", "At", ""], rows));
}

/// Nothing where no run has a map.
export function mapSection(view: View): HTMLElement | null {
  if (!view.tracks.some(({ run }) => run.map)) return null;
  const content = element("div", "map-cards");
  const node = section("map", "Map", content);
  view.active.watch(({ run }) => {
    node.hidden = !run.map;
    const cards = run.map ? [ledgerCard(view, run.map), controlCard(view, run.map)] : [];
    content.replaceChildren(...cards.filter((card) => card !== null));
  });
  return node;
}
