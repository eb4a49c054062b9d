// Cross-sections of the passage at the stations of the survey, all to one scale.

import { themed, whenThemeChanges } from "../base/colours";
import { button, element, whenNear, whenResized } from "../base/dom";
import { fileName, savePng } from "../base/download";
import { clock, niceStep, number } from "../base/format";
import { label } from "./map_paint";
import { stationsOf, type PlacedStation } from "./map_survey";
import { vectorButton, printable } from "../base/vector";
import type { View } from "../model/view";

type Context = CanvasRenderingContext2D;

const kMost = 24;
const kCell_px = 150;
const kHead_px = 20;
const kPrinted_px = 690; // the width of a sheet

/// Splays as seen along the way, to the right and up.
function outline(station: PlacedStation): [number, number][] {
  const flat = station.splays.map((s): [number, number] => [s[0] * station.right[0] + s[1] * station.right[1], s[2]]);
  return flat.sort((a, b) => Math.atan2(a[1], a[0]) - Math.atan2(b[1], b[0]));
}

/// Farthest wall that a section shows, m.
function reach(station: PlacedStation): number {
  return Math.max(0.5, ...station.size_m.map((v) => v ?? 0), ...outline(station).map(([x, y]) => Math.max(Math.abs(x), Math.abs(y))));
}

/// Evenly chosen, where there are many.
function chosen(stations: PlacedStation[]): PlacedStation[] {
  const useful = stations.filter((s) => s.splays.length > 2 || s.size_m.some((v) => v !== null));
  const every = Math.ceil(useful.length / kMost);
  return useful.filter((_, i) => i % Math.max(1, every) === 0);
}

class Sections {
  readonly canvas = element("canvas", "sections");
  private places: { station: PlacedStation; x: number; y: number }[] = [];

  constructor(private view: View) {
    const draw = () => this.draw();
    view.active.watch(draw);
    view.time.watch(draw);
    whenThemeChanges(draw);
    this.canvas.addEventListener("click", (event) => {
      const box = this.canvas.getBoundingClientRect();
      const found = this.places.find(({ x, y }) => event.clientX - box.left >= x && event.clientX - box.left < x + kCell_px &&
        event.clientY - box.top >= y && event.clientY - box.top < y + kCell_px + kHead_px);
      if (found) view.time.set(view.active.value.t_s[found.station.pose]);
    });
  }

  height(width: number): number {
    const columns = Math.max(1, Math.floor(width / kCell_px));
    return Math.max(1, Math.ceil(chosen(stationsOf(this.view.active.value)).length / columns)) * (kCell_px + kHead_px) + 30;
  }

  draw(): void {
    const width = this.canvas.parentElement?.clientWidth ?? 0;
    const context = this.canvas.getContext("2d", { willReadFrequently: true });
    if (!context || width === 0) return;
    const ratio = Math.min(2, window.devicePixelRatio);
    const height = this.height(width);
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    this.canvas.style.height = `${height}px`;
    context.scale(ratio, ratio);
    this.drawWith(context, width, height);
  }

  drawWith(c: Context, width: number, height: number): void {
    const stations = chosen(stationsOf(this.view.active.value));
    const columns = Math.max(1, Math.floor(width / kCell_px));
    const scale = (0.46 * kCell_px) / Math.max(0.5, ...stations.map(reach));
    const now = this.view.pose();
    const nearest = stations.reduce<PlacedStation | null>((a, b) => (a && Math.abs(a.pose - now) <= Math.abs(b.pose - now) ? a : b), null);
    this.places = stations.map((station, i) => ({
      station, x: (i % columns) * kCell_px, y: Math.floor(i / columns) * (kCell_px + kHead_px),
    }));
    for (const { station, x, y } of this.places) this.drawOne(c, station, x, y, scale, station === nearest);
    const metres = niceStep(120 / scale);
    c.fillStyle = themed("ink");
    c.fillRect(8, height - 12, metres * scale, 4);
    label(c, `${number(metres, 1)} m`, 14 + metres * scale, height - 10);
  }

  private drawOne(c: Context, station: PlacedStation, x: number, y: number, scale: number, isNear: boolean): void {
    const cx = x + kCell_px / 2, cy = y + kHead_px + kCell_px / 2;
    const points = outline(station);
    c.beginPath();
    points.forEach(([u, v], i) => (i === 0 ? c.moveTo(cx + scale * u, cy - scale * v) : c.lineTo(cx + scale * u, cy - scale * v)));
    c.closePath();
    c.fillStyle = themed("quiet");
    c.fill();
    c.strokeStyle = isNear ? themed("accent") : themed("landmark");
    c.lineWidth = 1.6;
    if (points.length > 2) c.stroke();
    c.fillStyle = themed("landmark");
    for (const [u, v] of points) c.fillRect(cx + scale * u - 1.5, cy - scale * v - 1.5, 3, 3);
    const [left, right, up, down] = station.size_m;
    c.strokeStyle = themed("ink");
    c.lineWidth = 1;
    for (const [length, dx, dy] of [[left, -1, 0], [right, 1, 0], [up, 0, -1], [down, 0, 1]] as [number | null, number, number][]) {
      if (length === null) continue;
      c.beginPath();
      c.moveTo(cx, cy);
      c.lineTo(cx + scale * length * dx, cy + scale * length * dy);
      c.stroke();
    }
    c.fillStyle = isNear ? themed("accent") : themed("ink");
    c.beginPath();
    c.arc(cx, cy, 3, 0, 2 * Math.PI);
    c.fill();
    label(c, `${station.index} · ${clock(this.view.active.value.t_s[station.pose])}`, x + 6, y + 10);
  }
}

/// Nothing where no run has a survey.
export function sectionsCard(view: View): HTMLElement | null {
  if (!view.tracks.some(({ run }) => run.stations?.length)) return null;
  const sections = new Sections(view);
  const name = () => fileName(view.active.value.run.name, "cross_sections");
  const box = element("div", "sections-box", sections.canvas);
  const drawVector = { width: () => Math.max(300, box.clientWidth), height: (w: number) => sections.height(w),
    draw: (c: Context, w: number, h: number) => sections.drawWith(c, w, h) };
  const tools = element("div", "tools", vectorButton(name, drawVector),
    button("PNG", "Download this picture", () => savePng(name(), sections.canvas, "Cross-sections")));
  const note = element("p", "note", "Seen in the direction of travel: at each station, distances left, right, up and down, and wall points " +
    "near it, joined. A number without walls had too few points. Click on one to go there.");
  const card = element("article", "card wide sections-card", element("header", "", element("h3", "", "Cross-sections"), tools), box, note);
  view.active.watch(({ run }) => (card.hidden = !run.stations?.length));
  whenNear(card, () => whenResized(box, () => sections.draw()));
  printable(box, sections.canvas, drawVector, () => kPrinted_px);
  return card;
}
