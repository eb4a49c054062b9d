// A ribbon over time that shows in which state something was, as a plot without curves.

import type uPlot from "uplot";
import { kKinds, themed } from "../base/colours";
import { element } from "../base/dom";
import { plotCard, type PlotSpec } from "./plot";
import type { View } from "../model/view";

const kGood = new Set(["tracking", "used"]);
const kSilent = new Set(["off", "missing", "waiting", "none"]);
const kTroubles = [kKinds[1], kKinds[4], kKinds[3], kKinds[5], kKinds[2]];

/// Good is blue, silence grey; troubles take the other colours in the order of their names.
function colourOf(word: string, words: string[]): string {
  if (kGood.has(word)) return kKinds[0];
  if (kSilent.has(word)) return themed("faint");
  const troubles = words.filter((w) => !kGood.has(w) && !kSilent.has(w)).sort();
  return kTroubles[troubles.indexOf(word) % kTroubles.length];
}

interface Strip {
  name: string;
  column: string;
}

const kRibbon_px = 22;

function drawRibbons(plot: uPlot, t_s: number[], rows: { words: string[]; colours: Map<string, string> }[]): void {
  const { ctx } = plot;
  const { left, top, width, height } = plot.bbox;
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, top, width, height);
  ctx.clip();
  rows.forEach(({ words, colours }, k) => {
    const y = top + (height * (k + 0.1)) / rows.length;
    const h = (0.8 * height) / rows.length;
    for (let i = 0; i < words.length; ) {
      let end = i + 1;
      while (end < words.length && words[end] === words[i]) ++end;
      const x0 = plot.valToPos(t_s[i], "x", true);
      const x1 = plot.valToPos(t_s[Math.min(end, words.length - 1)], "x", true);
      ctx.fillStyle = colours.get(words[i]) ?? "grey";
      // Never thinner than a hair, so that a short trouble is seen in a long dive.
      ctx.fillRect(x0, y, Math.max(x1 - x0, devicePixelRatio), h);
      i = end;
    }
  });
  ctx.restore();
}

export function statusCard(view: View, id: string, title: string, strips: Strip[]): HTMLElement {
  const legend = element("ul", "legend");
  const card = plotCard(view, (v): PlotSpec | null => {
    const { states } = v.active.value.run;
    const rows = strips
      .filter(({ column }) => states.words[column]?.some((word) => word !== "off" && word !== "none"))
      .map(({ name, column }) => ({ name, words: states.words[column] }));
    if (rows.length === 0) return null;
    const coloured = rows.map(({ name, words }) => {
      const found = [...new Set(words)];
      return { name, words, colours: new Map(found.map((w) => [w, colourOf(w, found)])) };
    });
    legend.replaceChildren(...coloured.flatMap(({ name, words, colours }) => legendOf(name, words, colours)));
    return {
      id, title, unit: "", t_s: states.t_s, height_px: 52 + kRibbon_px * rows.length, range: [0, 1],
      rows: rows.map(({ name }) => name),
      series: coloured.map(({ name, words }) => ({ label: name, values: words.map(() => null), words, colour: "transparent" })),
      hook: (plot) => drawRibbons(plot, states.t_s, coloured),
    };
  });
  card.classList.add("wide");
  card.append(legend);
  return card;
}

function legendOf(name: string, words: string[], colours: Map<string, string>): HTMLElement[] {
  return [...colours].map(([word, colour]) => {
    const swatch = element("i");
    swatch.style.background = colour;
    const share = (100 * words.filter((w) => w === word).length) / words.length;
    return element("li", "", swatch, `${name}: ${word} ${share < 0.1 ? "< 0.1" : share.toFixed(1)} %`);
  });
}
