// The trajectory in space and on maps, with what can be chosen about it.

import { available, colourScale } from "./model/colouring";
import { gradient, kLoopColour, kMapColour, whenThemeChanges } from "./base/colours";
import type { RunMap } from "./model/data";
import { button, choice, element, section, toggle, whenNear } from "./base/dom";
import { fileName, saveCsv, savePng } from "./base/download";
import { shownPoints } from "./model/map_points";
import { MapView } from "./plan/map_view";
import { pointColours, type PointColouring } from "./model/points";
import { posePanel } from "./panels/pose_panel";
import type { ProjectionName } from "./model/projections";
import { sectionsCard } from "./plan/sections_view";
import { SpaceView } from "./space/space_view";
import type { Kind, Track } from "./model/track";
import { printable, vectorButton, type VectorDrawing } from "./base/vector";
import type { Shown, View } from "./model/view";

/// What the colours of something mean; hidden while they mean nothing.
function colourBar(view: View, scaleOf: () => { title: string; low: string; high: string } | null): HTMLElement {
  const low = element("span");
  const high = element("span");
  const title = element("span", "title");
  const bar = element("span", "bar");
  const node = element("div", "colour-bar", title, element("span", "scale", low, bar, high));
  const show = () => {
    const scale = scaleOf();
    node.hidden = !scale?.title;
    if (!scale) return;
    title.textContent = scale.title;
    low.textContent = scale.low;
    high.textContent = scale.high;
    bar.style.background = gradient();
    bar.hidden = !scale.low;
  };
  view.active.watch(show);
  view.colouring.watch(show);
  view.pointColouring.watch(show);
  view.shown.watch(show);
  whenThemeChanges(show);
  return node;
}

function toggles(view: View): HTMLElement {
  const change = (what: keyof Shown) => (on: boolean) => view.shown.set({ ...view.shown.value, [what]: on });
  const row = element("div", "toggles", toggle("Landmarks", true, change("landmarks")));
  const add = (text: string, what: keyof Shown, colour?: string) => row.append(keyed(toggle(text, view.shown.value[what], change(what)), colour));
  if (view.tracks.some((t) => t.walls)) add("Walls", "walls");
  if (view.tracks.some((t) => t.run.evaluation)) add("Reference (thin line)", "reference");
  if (view.tracks.some((t) => t.run.pictures.length > 0)) add("Picture places", "pictures");
  if (view.tracks.some((t) => t.run.stations?.length)) add("Stations", "stations");
  const has = (what: (map: RunMap) => boolean) => view.tracks.some(({ run }) => run.map && what(run.map));
  if (view.kinds().length > 1 || has((map) => map.path !== null)) {
    add(view.kinds().length > 1 ? "Other solutions" : "In the map", "others", has((map) => map.path !== null) ? kMapColour : undefined);
  }
  if (has((map) => map.loops.length > 0 || map.control.length > 0)) add("Loops and control points", "loops", kLoopColour);
  if (view.background) add("Background", "background");
  return row;
}

/// A toggle with the colour of what it shows.
function keyed(node: HTMLElement, colour?: string): HTMLElement {
  if (!colour) return node;
  const swatch = element("i");
  swatch.style.background = colour;
  node.append(swatch);
  return node;
}

/// All states that the page holds.
function saveStates(track: Track): void {
  const { states, run } = track;
  saveCsv(fileName(run.name, track.kind, "states"), [
    { name: "time [s]", values: states.t_s },
    ...Object.entries(states.words).map(([column, values]) => ({ name: column, values })),
    ...Object.entries(states.numbers).map(([column, values]) => ({ name: column, values })),
  ]);
}

/// Made once it comes into sight, after the rest of the page: without a graphics card it takes its time.
function spaceCard(view: View): HTMLElement {
  const tools = element("div", "tools",
    button("CSV", "Download the states that this page holds", () => saveStates(view.active.value)));
  const card = element("article", "card space-card", element("header", "", element("h3", "", "In space"), tools));
  whenNear(card, () => {
    try {
      const space = new SpaceView(view);
      tools.prepend(
        button("Oblique", "Look from the south-west, from above", () => space.lookFrom("oblique")),
        button("Top", "Look from above", () => space.lookFrom("top")),
        button("Side", "Look from the south", () => space.lookFrom("side")),
        button("PNG", "Download this picture",
          () => savePng(fileName(view.active.value.run.name, "trajectory"), space.canvas, "Trajectory")));
      card.append(space.node);
    } catch {
      card.append(element("p", "note", "This browser has no WebGL, so there is no view in space; the maps below work without."));
    }
  });
  return card;
}

const kMapHeight_px = 360;
const kPrinted_px = 690; // the width of a sheet

function mapCard(view: View, name: ProjectionName, choices: ProjectionName[] = []): HTMLElement {
  const map = new MapView(view, name);
  const head = element("h3");
  const title = () => (head.textContent = map.projection.title);
  view.active.watch(title);
  const drawing: VectorDrawing = {
    width: () => Math.max(320, map.node.clientWidth), height: () => Math.max(kMapHeight_px, map.node.clientHeight),
    draw: (c, width, height) => map.drawWith(c, width, height, 2),
  };
  const file = () => fileName(view.active.value.run.name, map.projection.title.toLowerCase());
  const tools = element("div", "tools",
    button("+", "Nearer", () => map.zoom(1.5)), button("−", "Farther", () => map.zoom(1 / 1.5)), button("Fit", "Show everything", () => map.fit()),
    vectorButton(file, drawing), button("PNG", "Download this picture", () => savePng(file(), map.canvas, map.projection.title)));
  const kinds: Record<ProjectionName, string> = { plan: "Plan", side: "Side", extended: "Extended" };
  if (choices.length) {
    tools.prepend(choice("Elevation", choices.map((value) => ({ value, text: kinds[value] })), name, (value) => {
      map.show(value);
      requestAnimationFrame(() => requestAnimationFrame(title));
    }));
  }
  printable(map.node, map.canvas, drawing, () => kPrinted_px);
  return element("article", `card map-card map-${name}`, element("header", "", head, tools), map.node);
}

const kKindTexts: Record<Kind, string> = { run: "Run", refined: "Refined", map: "Map" };
const kKindTitles: Record<Kind, string> = {
  run: "estimated image by image while the dive went on", refined: "all images of the dive solved together", map: "closed by loops, tags and control points",
};

function solutionChoice(view: View): HTMLElement | null {
  const kinds = view.kinds();
  if (kinds.length < 2) return null;
  const note = element("span", "note");
  view.active.watch(({ kind }) => (note.textContent = kKindTitles[kind]));
  return element("div", "group solution", element("span", "label", "Trajectory"),
    choice("Trajectory", kinds.map((value) => ({ value, text: kKindTexts[value] })), view.active.value.kind, (kind) => view.showKind(kind)), note);
}

function pointChoice(view: View): HTMLElement {
  const list: [PointColouring, string][] = [["plain", "Plain"], ["height", "Height"], ["distance", "Distance"], ["uncertainty", "Uncertainty"]];
  if (view.tracks.some((t) => t.walls?.rgb)) list.push(["image", "Image"]);
  return element("div", "group", element("span", "label", "Points"),
    choice("Points", list.map(([value, text]) => ({ value, text })), "plain", (value) => view.pointColouring.set(value)));
}

function ellipseChoice(view: View): HTMLElement {
  const select = element("select");
  for (const [value, text] of [[0, "none"], [1, "1 σ"], [3, "3 σ"], [10, "10 σ"], [30, "30 σ"], [100, "100 σ"]] as [number, string][]) {
    select.append(new Option(text, String(value)));
  }
  select.addEventListener("change", () => view.ellipses.set(Number(select.value)));
  return element("label", "group ellipses", element("span", "label", "Ellipses"), select);
}

export function trajectorySection(view: View): HTMLElement {
  const colours = available(view.tracks);
  const bar = element("div", "toolbar", solutionChoice(view),
    element("div", "group", element("span", "label", "Colour"), choice("Colour", colours, "time", (v) => view.colouring.set(v))),
    colourBar(view, () => colourScale(view.active.value, view.colouring.value)),
    pointChoice(view),
    colourBar(view, () => {
      const points = shownPoints(view, view.active.value);
      return points && view.pointColouring.value !== "plain" ? pointColours(points, view.active.value, view.pointColouring.value) : null;
    }),
    ellipseChoice(view), toggles(view));
  return section("trajectory", "Trajectory", bar,
    element("div", "split", spaceCard(view), posePanel(view)),
    element("div", "pair", mapCard(view, "plan"), mapCard(view, "side", ["side", "extended"]), sectionsCard(view)));
}
