// The way from above, from the side or unrolled, on a map with a scale.

import { isDark, whenThemeChanges } from "../base/colours";
import { element, whenResized } from "../base/dom";
import type { Vec3 } from "../base/geometry";
import { drawBackground, whenBackgroundLoads } from "./background";
import { MapFrame } from "./map_frame";
import { drawControl, drawLoops, drawPictures, drawSelection, drawWays, type Placing } from "./map_paint";
import { pointsPicture } from "../model/map_points";
import { drawEllipses, drawNorthArrow, drawScaleBar, drawStations, wallsBeside } from "./map_survey";
import { projectionOf, type Projection, type ProjectionName } from "../model/projections";
import type { Track } from "../model/track";
import { Tip, poseText } from "./tip";
import type { View } from "../model/view";

const kPick_px = 25;

export class MapView {
  readonly canvas = element("canvas", "map");
  private frame: MapFrame | null = null;
  private moves: [number, number, number, number, number][] = []; // factor, x, y, dx, dy
  private tip = new Tip();
  readonly node = element("div", "map-box", this.canvas, this.tip.node);
  private pending = 0;
  private points: { key: string; picture: HTMLCanvasElement } | null = null;
  projection: Projection;

  constructor(private view: View, private name: ProjectionName) {
    this.projection = projectionOf(name, view);
    whenResized(this.node, () => this.draw());
    for (const signal of [view.active, view.colouring, view.pointColouring, view.ellipses, view.mark, view.shown, view.time]) {
      (signal as { watch(listener: () => void): void }).watch(() => this.draw());
    }
    whenThemeChanges(() => this.draw());
    whenBackgroundLoads(() => this.draw());
    this.canvas.addEventListener("pointermove", (event) => this.hover(event));
    this.canvas.addEventListener("pointerleave", () => this.tip.hide());
    this.canvas.addEventListener("wheel", (event) => {
      // A wheel without a key scrolls the page.
      if (!event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      const box = this.canvas.getBoundingClientRect();
      this.zoom(1.2 ** (-event.deltaY / 100), event.clientX - box.left, event.clientY - box.top);
    }, { passive: false });
    this.listenToDrags();
  }

  show(name: ProjectionName): void {
    this.name = name;
    this.fit();
  }

  fit(): void {
    this.moves = [];
    this.canvas.classList.remove("zoomed");
    this.draw();
  }

  /// About the middle where no place is given.
  zoom(factor: number, x = this.node.clientWidth / 2, y = this.node.clientHeight / 2): void {
    this.moves.push([factor, x, y, 0, 0]);
    this.canvas.classList.add("zoomed");
    this.draw();
  }

  /// A drag moves the map; a press without one selects a pose.
  private listenToDrags(): void {
    let from: PointerEvent | null = null;
    let isDrag = false;
    this.canvas.addEventListener("pointerdown", (event) => {
      from = event;
      isDrag = false;
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (!from || event.buttons === 0) return;
      const dx = event.clientX - from.clientX, dy = event.clientY - from.clientY;
      if (!isDrag && Math.hypot(dx, dy) < 5) return;
      isDrag = true;
      from = event;
      this.moves.push([1, 0, 0, dx, dy]);
      this.canvas.classList.add("zoomed");
      this.draw();
    });
    this.canvas.addEventListener("click", (event) => {
      from = null;
      const pose = isDrag ? -1 : this.nearest(event);
      if (pose >= 0) this.view.time.set(this.view.active.value.t_s[pose]);
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
    this.drawWith(context, width, height, ratio);
  }

  /// The whole map with any 2-D context; `ratio`: pixels of the points' picture to one of the map.
  drawWith(c: CanvasRenderingContext2D, width: number, height: number, ratio: number): void {
    const { view } = this;
    this.projection = projectionOf(this.name, view);
    const frame = this.frameOf(width, height);
    this.frame = frame;
    const isPlan = this.name === "plan";
    const place: Placing = (track, p, pose) => {
      const [u, v] = this.projection.flat(track, p, pose);
      return [frame.x(u), frame.y(v)];
    };
    frame.drawRulers(c, this.projection.axes);
    frame.clip(c);
    const { shown } = view;
    if (isPlan && shown.value.background && view.background) drawBackground(c, view.background, frame);
    c.drawImage(this.pointsOn(frame, width, height, ratio), 0, 0, width, height);
    for (const track of this.projection.tracks) {
      if (view.ellipses.value > 0) drawEllipses(c, view, track, this.projection, frame, place, view.ellipses.value);
    }
    drawWays(c, view, this.projection.tracks, place);
    for (const track of this.projection.tracks) {
      if (shown.value.stations && track === view.active.value) drawStations(c, track, place, isPlan);
      if (shown.value.loops) drawLoops(c, track, place);
      if (shown.value.loops) drawControl(c, track, place);
    }
    if (shown.value.pictures) drawPictures(c, view.active.value, place);
    drawSelection(c, view, place);
    drawScaleBar(c, frame);
    if (isPlan) drawNorthArrow(c, frame, view);
    c.restore();
  }

  private pointsOn(frame: MapFrame, width: number, height: number, ratio: number): HTMLCanvasElement {
    const { view } = this;
    const { landmarks, walls } = view.shown.value;
    const track = view.active.value;
    const key = [this.name, frame.key(), ratio, view.pointColouring.value, landmarks, walls, track.run.name, track.kind,
      track.landmarks.xyz.length, isDark()].join();
    if (this.points?.key !== key) {
      this.points = { key, picture: pointsPicture(view, this.projection, frame, width, height, ratio) };
    }
    return this.points.picture;
  }

  private frameOf(width: number, height: number): MapFrame {
    const low: [number, number] = [Infinity, Infinity];
    const high: [number, number] = [-Infinity, -Infinity];
    const include = (track: Track, p: Vec3, pose: number) => {
      this.projection.flat(track, p, pose).forEach((v, k) => {
        low[k] = Math.min(low[k], v);
        high[k] = Math.max(high[k], v);
      });
    };
    for (const track of this.projection.tracks) {
      track.position.forEach((p, i) => include(track, p, i));
      if (this.view.shown.value.stations) {
        for (const { end, pose } of wallsBeside(track, this.name === "plan")) include(track, end, pose);
      }
      if (!this.projection.isUnrolled && track.kind !== "map") track.inMap.forEach((p) => include(track, p, 0));
    }
    const frame = low[0] > high[0] ? new MapFrame(width, height, [-1, -1], [1, 1]) : new MapFrame(width, height, low, high);
    for (const move of this.moves) frame.zoom(...move);
    return frame;
  }

  private nearest(event: MouseEvent): number {
    if (!this.frame) return -1;
    const track = this.view.active.value;
    const box = this.canvas.getBoundingClientRect();
    let best = kPick_px;
    let chosen = -1;
    track.position.forEach((p, i) => {
      const [u, v] = this.projection.flat(track, p, i);
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
    const pose = event.buttons === 0 ? this.nearest(event) : -1;
    if (pose < 0) return this.tip.hide();
    const box = this.node.getBoundingClientRect();
    this.tip.show(poseText(this.view, pose), event.clientX - box.left, event.clientY - box.top, box.width);
  }
}
