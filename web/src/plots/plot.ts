// One plot over time: a card with title, curves, legend with figures under the pointer, and downloads.

import uPlot from "uplot";
import { isPrinting, themed, whenThemeChanges } from "../base/colours";
import { button, element, whenNear, whenResized } from "../base/dom";
import { fileName, saveCsv, savePng } from "../base/download";
import { clock, number } from "../base/format";
import { drawingOn, printable, vectorButton, type VectorDrawing } from "../base/vector";
import type { View } from "../model/view";

export interface Series {
  label: string;
  values: (number | null)[];
  words?: string[]; // in place of the values: what was the case, to be read and downloaded, not drawn as a curve
  colour: string;
  width?: number;
  dashed?: boolean;
  hidden?: boolean; // edge of a band: no entry of its own in the legend
}

export interface PlotSpec {
  id: string;
  title: string;
  unit: string;
  axis?: string; // what the y axis says, where not the unit
  t_s: number[];
  series: Series[];
  bands?: { upper: number; lower: number; colour: string }[]; // between series, by number
  downwards?: boolean; // greater values lower on the page
  rows?: string[]; // names on the y axis in place of figures, from above
  note?: string;
  height_px?: number;
  hook?: uPlot.Hooks.Defs["draw"];
  range?: [number, number];
}

const kHeight_px = 190;
const kPrinted_px = 335; // half of a sheet
const kSync = uPlot.sync("time");

function axes(spec: PlotSpec): uPlot.Axis[] {
  const common: uPlot.Axis = {
    stroke: themed("muted"), grid: { stroke: themed("grid"), width: 1 }, ticks: { show: false },
    font: "11px system-ui, sans-serif", labelFont: "11px system-ui, sans-serif", labelSize: 16,
  };
  const last = spec.t_s[spec.t_s.length - 1] ?? 0;
  const { rows } = spec;
  const time: uPlot.Axis = {
    ...common, size: 26, space: 60, incrs: kTimeSteps_s, label: last < 3600 ? "time (min:s)" : "time (h:min:s)",
    values: (_, ticks, __, ___, step) => ticks.map((t) => clock(t, step < 1 ? 1 : 0)),
  };
  if (!rows) return [time, { ...common, size: 54, label: spec.axis ?? spec.unit, values: (_, ticks) => tickTexts(ticks) }];
  const places = rows.map((_, i) => 1 - (i + 0.5) / rows.length);
  return [time, { ...common, size: 92, splits: () => places, values: () => rows, grid: { show: false } }];
}

const kTimeSteps_s = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200];

/// All with as many decimals as their step needs.
function tickTexts(ticks: number[]): string[] {
  const step = ticks.length > 1 ? Math.abs(ticks[1] - ticks[0]) : 1;
  let digits = 0;
  while (digits < 6 && Math.abs(step * 10 ** digits - Math.round(step * 10 ** digits)) > 1e-3) ++digits;
  return ticks.map((v) => (digits > 5 ? v.toExponential(1) : v.toFixed(digits)).replace("-", "−"));
}

function curves(spec: PlotSpec): uPlot.Series[] {
  const value = (s: Series) => (_: uPlot, v: number | null, __: number, i: number | null) =>
    s.words ? (i === null ? "–" : s.words[i]) : number(v, 4);
  const time: uPlot.Series = { label: "time", value: (_, v) => (v === null || v === undefined ? "–" : clock(v, 1)) };
  return [time, ...spec.series.map((s) => ({
    label: s.label, stroke: s.colour, width: s.width ?? 1.4, dash: s.dashed ? [5, 4] : undefined, value: value(s),
    points: { show: false }, spanGaps: false, 
    // Bands are drawn as far as they fit: the uncertainty of the first moments would flatten all that follows.
    ...(s.hidden ? { class: "hidden", auto: false } : {}),
  }))];
}

function paddedRange(low: number, high: number): [number, number] {
  if (low === null || high === null) return [0, 1];
  const span = high > low ? high - low : Math.abs(high) || 1;
  // A range that nearly reaches zero shows it.
  const from = low >= 0 && low < 0.3 * span ? 0 : low - 0.12 * span;
  return [from, high + 0.12 * span];
}

/// A line at the selected pose.
function drawSelection(plot: uPlot, t: number): void {
  if (isPrinting()) return;
  const x = plot.valToPos(t, "x", true);
  const { left, top, width, height } = plot.bbox;
  if (!(x >= left && x <= left + width)) return;
  plot.ctx.save();
  plot.ctx.strokeStyle = themed("accent");
  plot.ctx.lineWidth = 1.5 * devicePixelRatio;
  plot.ctx.beginPath();
  plot.ctx.moveTo(x, top);
  plot.ctx.lineTo(x, top + height);
  plot.ctx.stroke();
  plot.ctx.restore();
}

function options(spec: PlotSpec, view: View, width: number): uPlot.Options {
  return {
    width, height: spec.height_px ?? kHeight_px, padding: [8, 12, 0, 0],
    scales: {
      x: { time: false },
      y: { dir: spec.downwards ? -1 : 1, range: spec.range ?? ((_, low, high) => paddedRange(low, high)) },
    },
    axes: axes(spec), series: curves(spec),
    bands: spec.bands?.map((b) => ({ series: [b.upper, b.lower], fill: b.colour })),
    cursor: { sync: { key: kSync.key }, drag: { x: true, y: false }, points: { size: 7 } },
    hooks: {
      draw: [...(spec.hook ? ([spec.hook].flat() as ((plot: uPlot) => void)[]) : []),
        (plot) => drawSelection(plot, view.time.value)],
    },
  };
}

/// The plot on another context. uPlot draws later than it is made unless it is asked for a batch.
function drawPlot(context: CanvasRenderingContext2D, spec: PlotSpec, view: View, width: number): void {
  drawingOn(context, () => {
    const plot = new uPlot({ ...options(spec, view, width), legend: { show: false } }, dataOf(spec), element("div"));
    plot.batch(() => undefined);
    plot.destroy();
  });
}

/// A click that is no drag selects the moment under the pointer.
function selectOnClick(plot: uPlot, view: View): void {
  let down = 0;
  plot.over.addEventListener("mousedown", (event) => (down = event.clientX));
  plot.over.addEventListener("click", (event) => {
    if (Math.abs(event.clientX - down) < 4) view.time.set(plot.posToVal(plot.cursor.left ?? 0, "x"));
  });
}

/// A card that makes its plot once it comes into sight; `spec` is asked again whenever the run changes, and
/// the card vanishes while there is nothing to plot.
export function plotCard(view: View, spec: (view: View) => PlotSpec | null): HTMLElement {
  const title = element("h3");
  const drawing = element("div", "drawing");
  const note = element("p", "note");
  let plot: uPlot | null = null;
  let current: PlotSpec | null = null;
  const name = () => fileName(view.active.value.run.name, current?.id ?? "plot");
  const vector: VectorDrawing = {
    width: () => Math.max(320, drawing.clientWidth), height: () => current?.height_px ?? kHeight_px, ratio: () => devicePixelRatio,
    draw: (context, width) => current && drawPlot(context, current, view, width),
  };
  const tools = element("div", "tools",
    button("CSV", "Download these figures", () => current && saveCsv(name(), [
      { name: "time [s]", values: current.t_s },
      ...current.series.map((s) => ({ name: current!.unit ? `${s.label} [${current!.unit}]` : s.label, values: s.words ?? s.values })),
    ])),
    vectorButton(name, vector),
    button("PNG", "Download this picture", () => plot && savePng(name(), plot.ctx.canvas, pictureTitle(current!))));
  const card = element("article", "card plot", element("header", "", title, tools), drawing, note);
  const make = () => {
    plot?.destroy();
    plot = null;
    if (!current) return;
    plot = new uPlot(options(current, view, drawing.clientWidth), dataOf(current), drawing);
    selectOnClick(plot, view);
  };
  let seen = false;
  view.active.watch(() => {
    const before = current;
    current = spec(view);
    card.hidden = current === null;
    if (!current) return;
    card.id = `plot-${current.id}`;
    title.textContent = current.unit ? `${current.title} (${current.unit})` : current.title;
    note.textContent = current.note ?? "";
    if (!seen) return;
    // A run that goes on has more of the same.
    if (plot && before && haveSameCurves(before, current)) plot.setData(dataOf(current));
    else make();
  });
  view.time.watch(() => plot?.redraw(false));
  whenThemeChanges(() => {
    current = spec(view);
    if (seen) make();
  });
  whenNear(card, () => {
    seen = true;
    make();
    whenResized(drawing, (width) => plot && width > 0 && plot.setSize({ width, height: current?.height_px ?? kHeight_px }));
  });
  printable(drawing, drawing, vector, () => (card.classList.contains("wide") ? 2 * kPrinted_px : kPrinted_px));
  return card;
}

function dataOf(spec: PlotSpec): uPlot.AlignedData {
  return [spec.t_s, ...spec.series.map((s) => s.values)] as uPlot.AlignedData;
}

/// What is drawn by a hook may be another thing under the same name.
function haveSameCurves(a: PlotSpec, b: PlotSpec): boolean {
  const names = (spec: PlotSpec) => spec.series.map((s) => s.label).join();
  return a.id === b.id && a.title === b.title && names(a) === names(b) && !b.hook;
}

function pictureTitle(spec: PlotSpec): string {
  const labels = spec.series.filter((s) => !s.hidden).map((s) => s.label).join(", ");
  return `${spec.title}${spec.unit ? ` (${spec.unit})` : ""}${labels ? `: ${labels}` : ""}`;
}
