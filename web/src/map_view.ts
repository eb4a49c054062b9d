// The way from above or from the side, on a flat map with a scale.

import { css, kKinds, kLoopColour, kMapColour, themed, whenThemeChanges } from "./colours";
import { colourScale } from "./colouring";
import { element, whenResized } from "./dom";
import type { Vec3 } from "./geometry";
import { MapFrame } from "./map_frame";
import { loopEnds, type Track } from "./track";
import { Tip, poseText } from "./tip";
import type { View } from "./view";
import { worldNames } from "./world";

export type Flattening = { axes: [string, string]; flat: (p: Vec3) => [number, number] };

export function fromAbove(view: View): Flattening {
  const names = worldNames(view);
  return { axes: [names.x, names.y], flat: (p) => [p[0], p[1]] };
}

/// Seen across the direction in which the tracks reach farthest.
export function fromTheSide(view: View): Flattening {
  const { tracks } = view;
  let xx = 0, xy = 0, yy = 0, n = 0, mx = 0, my = 0;
  for (const { position } of tracks) for (const p of position) { mx += p[0]; my += p[1]; ++n; }
  for (const { position } of tracks) {
    for (const p of position) {
      const x = p[0] - mx / n, y = p[1] - my / n;
      xx += x * x; xy += x * y; yy += y * y;
    }
  }
  const angle = Math.atan2(2 * xy, xx - yy) / 2;
  const c = Math.cos(angle), s = Math.sin(angle);
  const bearing = Math.round((90 - (angle * 180) / Math.PI + 360) % 360);
  const along = worldNames(view).knowsNorth ? `along ${String(bearing).padStart(3, "0")}° (m)` : "horizontal (m)";
  return { axes: [along, "up (m)"], flat: (p) => [c * p[0] + s * p[1], p[2]] };
}

const kPick_px = 25;

export class MapView {
  readonly canvas = element("canvas", "map");
  private frame: MapFrame | null = null;
  private tip = new Tip();
  readonly node = element("div", "map-box", this.canvas, this.tip.node);
  private pending = 0;

  constructor(private view: View, private flattening: (view: View) => Flattening) {
    whenResized(this.node, () => this.draw());
    view.active.watch(() => this.draw());
    view.colouring.watch(() => this.draw());
    view.shown.watch(() => this.draw());
    view.time.watch(() => this.draw());
    whenThemeChanges(() => this.draw());
    this.canvas.addEventListener("pointermove", (event) => this.hover(event));
    this.canvas.addEventListener("pointerleave", () => this.tip.hide());
    this.canvas.addEventListener("click", (event) => {
      const pose = this.nearest(event);
      if (pose >= 0) view.time.set(view.active.value.t_s[pose]);
    });
  }

  private draw(): void {
    cancelAnimationFrame(this.pending);
    this.pending = requestAnimationFrame(() => this.drawNow());
  }

  private drawNow(): void {
    const width = this.node.clientWidth;
    const height = this.node.clientHeight;
    // Drawn by the processor: without a graphics card, an accelerated canvas takes ten times as long.
    const context = this.canvas.getContext("2d", { willReadFrequently: true });
    if (!context || width === 0 || height === 0) return;
    const ratio = Math.min(2, window.devicePixelRatio);
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    context.scale(ratio, ratio);
    const { flat, axes } = this.flattening(this.view);
    this.frame = this.frameOf(width, height, flat);
    this.frame.drawRulers(context, axes);
    context.clip();
    this.drawContent(context, this.frame, flat);
  }

  private frameOf(width: number, height: number, flat: Flattening["flat"]): MapFrame {
    const low: [number, number] = [Infinity, Infinity];
    const high: [number, number] = [-Infinity, -Infinity];
    for (const { position, inMap } of this.view.tracks) {
      for (const p of [...position, ...inMap]) {
        flat(p).forEach((v, k) => {
          low[k] = Math.min(low[k], v);
          high[k] = Math.max(high[k], v);
        });
      }
    }
    return low[0] > high[0] ? new MapFrame(width, height, [-1, -1], [1, 1]) : new MapFrame(width, height, low, high);
  }

  private drawContent(c: CanvasRenderingContext2D, frame: MapFrame, flat: Flattening["flat"]): void {
    const { active, tracks, shown } = this.view;
    const track = active.value;
    const place = (p: Vec3): [number, number] => {
      const [u, v] = flat(p);
      return [frame.x(u), frame.y(v)];
    };
    if (shown.value.landmarks) drawLandmarks(c, track, place);
    const path = track.run.evaluation?.path;
    if (shown.value.reference && path) {
      drawLine(c, path.x.map((x, i) => place([x, path.y[i], path.z[i]])), themed("ink"), 1.2);
    }
    tracks.forEach((other, i) => {
      if (other !== track) drawLine(c, other.position.map(place), kKinds[i % kKinds.length], 1.6);
    });
    if (shown.value.map && track.inMap.length > 1) drawLine(c, track.inMap.map(place), kMapColour, 1.6, [6, 4]);
    drawColoured(c, track, place, colourScale(track, this.view.colouring.value).colours);
    if (shown.value.loops) drawLoops(c, track, place);
    if (shown.value.pictures) drawPictures(c, track, place);
    if (track.position.length > 0) {
      const p = track.position[this.view.pose()];
      const [x, y] = place(p);
      const v = track.view[this.view.pose()];
      const [x1, y1] = place([p[0] + v[0], p[1] + v[1], p[2] + v[2]]);
      drawMarker(c, x, y, Math.atan2(y1 - y, x1 - x));
    }
  }

  private nearest(event: MouseEvent): number {
    if (!this.frame) return -1;
    const { flat } = this.flattening(this.view);
    const box = this.canvas.getBoundingClientRect();
    let best = kPick_px;
    let chosen = -1;
    this.view.active.value.position.forEach((p, i) => {
      const [u, v] = flat(p);
      const distance = Math.hypot(
        this.frame!.x(u) - (event.clientX - box.left), this.frame!.y(v) - (event.clientY - box.top));
      if (distance < best) {
        best = distance;
        chosen = i;
      }
    });
    return chosen;
  }

  private hover(event: PointerEvent): void {
    const pose = this.nearest(event);
    if (pose < 0) return this.tip.hide();
    const box = this.node.getBoundingClientRect();
    this.tip.show(poseText(this.view, pose), event.clientX - box.left, event.clientY - box.top, box.width);
  }
}

type Placing = (p: Vec3) => [number, number];

function drawLandmarks(c: CanvasRenderingContext2D, track: Track, place: Placing): void {
  c.fillStyle = themed("landmark");
  c.globalAlpha = 0.4;
  const xyz = track.landmarks;
  for (let i = 0; i + 2 < xyz.length; i += 3) {
    const [x, y] = place([xyz[i], xyz[i + 1], xyz[i + 2]]);
    c.fillRect(x, y, 1.2, 1.2);
  }
  c.globalAlpha = 1;
}

function drawLine(
  c: CanvasRenderingContext2D, points: [number, number][], colour: string, width: number, dashes: number[] = []
): void {
  c.strokeStyle = colour;
  c.lineWidth = width;
  c.setLineDash(dashes);
  c.beginPath();
  points.forEach(([x, y]) => c.lineTo(x, y));
  c.stroke();
  c.setLineDash([]);
}

/// A line between the poses that a loop joins, and a dot at the later one.
function drawLoops(c: CanvasRenderingContext2D, track: Track, place: Placing): void {
  c.strokeStyle = c.fillStyle = kLoopColour;
  c.lineWidth = 1.3;
  for (const [before, now] of loopEnds(track)) {
    c.beginPath();
    c.moveTo(...place(before));
    c.lineTo(...place(now));
    c.stroke();
    c.beginPath();
    c.arc(...place(now), 2.2, 0, 2 * Math.PI);
    c.fill();
  }
}

function drawColoured(
  c: CanvasRenderingContext2D, track: Track, place: Placing, colours: ([number, number, number] | null)[]
): void {
  c.lineWidth = 3;
  c.lineCap = "round";
  const faint = themed("faint");
  const colourAt = (i: number) => {
    const rgb = colours[i];
    return rgb ? css(rgb.map((v) => 8 * Math.round(v / 8)) as [number, number, number]) : faint;
  };
  // Stretches of one colour are drawn at once: thousands of short strokes take seconds where no graphics card helps.
  for (let i = 1; i < track.position.length;) {
    const colour = colourAt(i);
    c.strokeStyle = colour;
    c.beginPath();
    c.moveTo(...place(track.position[i - 1]));
    for (; i < track.position.length && colourAt(i) === colour; ++i) c.lineTo(...place(track.position[i]));
    c.stroke();
  }
}

/// Small rings where there is a picture to look at.
function drawPictures(c: CanvasRenderingContext2D, track: Track, place: Placing): void {
  c.strokeStyle = themed("ink");
  c.fillStyle = themed("surface");
  c.lineWidth = 1;
  let next = 0;
  for (const picture of track.run.pictures) {
    while (next < track.t_s.length && track.t_s[next] < picture.t_s) ++next;
    if (next >= track.t_s.length) return;
    c.beginPath();
    c.arc(...place(track.position[next]), 2.4, 0, 2 * Math.PI);
    c.fill();
    c.stroke();
  }
}

/// A dot with a wedge that shows where the camera looks.
function drawMarker(c: CanvasRenderingContext2D, x: number, y: number, angle: number): void {
  c.fillStyle = themed("accent");
  c.globalAlpha = 0.35;
  c.beginPath();
  c.moveTo(x, y);
  c.arc(x, y, 26, angle - 0.45, angle + 0.45);
  c.fill();
  c.globalAlpha = 1;
  c.beginPath();
  c.arc(x, y, 6, 0, 2 * Math.PI);
  c.fill();
  c.strokeStyle = themed("surface");
  c.lineWidth = 1.5;
  c.stroke();
}
