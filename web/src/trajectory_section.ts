// The trajectory in space, from above and from the side, with what can be chosen about it.

import { available, colourScale } from "./colouring";
import { gradient, kLoopColour, kMapColour, whenThemeChanges } from "./colours";
import type { RunMap } from "./data";
import { button, choice, element, section, toggle, whenNear } from "./dom";
import { fileName, saveCsv, savePng } from "./download";
import { fromAbove, fromTheSide, MapView, type Flattening } from "./map_view";
import { posePanel } from "./pose_panel";
import { SpaceView } from "./space_view";
import type { Track } from "./track";
import type { Shown, View } from "./view";
import { worldNames } from "./world";

function colourBar(view: View): HTMLElement {
  const low = element("span");
  const high = element("span");
  const title = element("span", "title");
  const bar = element("span", "bar");
  const show = () => {
    const scale = colourScale(view.active.value, view.colouring.value);
    title.textContent = scale.title;
    low.textContent = scale.low;
    high.textContent = scale.high;
    bar.style.background = gradient();
  };
  view.active.watch(show);
  view.colouring.watch(show);
  whenThemeChanges(show);
  return element("div", "colour-bar", title, element("span", "scale", low, bar, high));
}

function toggles(view: View): HTMLElement {
  const change = (what: keyof Shown) => (on: boolean) => view.shown.set({ ...view.shown.value, [what]: on });
  const row = element("div", "toggles", toggle("Landmarks", true, change("landmarks")));
  if (view.tracks.some((t) => t.run.evaluation)) row.append(toggle("Reference (thin line)", true, change("reference")));
  if (view.tracks.some((t) => t.run.pictures.length > 0)) row.append(toggle("Picture places", true, change("pictures")));
  const has = (what: (map: RunMap) => boolean) => view.tracks.some(({ run }) => run.map && what(run.map));
  if (has((map) => map.path !== null)) row.append(keyed(toggle("In the map", true, change("map")), kMapColour));
  if (has((map) => map.loops.length > 0)) row.append(keyed(toggle("Loops", true, change("loops")), kLoopColour));
  return row;
}

/// A toggle with the colour of what it shows.
function keyed(node: HTMLElement, colour: string): HTMLElement {
  const swatch = element("i");
  swatch.style.background = colour;
  node.append(swatch);
  return node;
}

/// All states that the page holds.
function saveStates(track: Track): void {
  const { states, name } = track.run;
  saveCsv(fileName(name, "states"), [
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

function mapCard(view: View, title: (view: View) => string, flattening: (view: View) => Flattening): HTMLElement {
  const map = new MapView(view, flattening);
  const head = element("h3");
  view.active.watch(() => (head.textContent = title(view)));
  const name = () => fileName(view.active.value.run.name, title(view).toLowerCase());
  const tools = element("div", "tools", button("PNG", "Download this picture", () => savePng(name(), map.canvas, title(view))));
  return element("article", "card", element("header", "", head, tools), map.node);
}

export function trajectorySection(view: View): HTMLElement {
  const colours = available(view.tracks);
  const bar = element("div", "toolbar",
    element("div", "group", element("span", "label", "Colour"), choice("Colour", colours, "time", (v) => view.colouring.set(v))),
    colourBar(view), toggles(view));
  return section("trajectory", "Trajectory", bar,
    element("div", "split", spaceCard(view), posePanel(view)),
    element("div", "pair", mapCard(view, () => `From above, ${worldNames(view).up} is up`, fromAbove),
      mapCard(view, () => "From the side", fromTheSide)));
}
