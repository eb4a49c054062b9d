// Clouds of points drawn a part at a time, so that millions of them do not stop the page without a graphics card.

import * as THREE from "three";

const kPoints = 1; // layer of the clouds
const kFirst = 100_000;
const kLeast = 20_000;
const kSlow_ms = 50;
const kQuick_ms = 25;

/// Whether the browser draws with more than the processor, as far as it tells.
export function hasGraphicsCard(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return false;
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return !/swiftshader|llvmpipe|software|basic render/i.test(name);
}

/// Draws a scene at once with as many points of its clouds as the machine draws in a twentieth of a second. Adds the
/// others in later pictures as long as nothing moves. Points must be in an order in which the first ones are spread over
/// all of them, as makePoints() gives it.
export class GradualDrawing {
  private clouds: { points: THREE.Points; count: number }[] = [];
  private budget = kFirst; // points of one picture; follows what the machine can do
  private drawn = 0; // share of the points that the picture has
  private isStale = true;
  private pending = 0;
  private fence: WebGLSync | null = null; // of the last picture
  private begun_ms = 0;
  private inWork = 0; // points of the last picture

  /// `prepare` comes before a new picture, `finish` after every part: for what lies over the scene.
  constructor(private renderer: THREE.WebGLRenderer, private scene: THREE.Scene, private camera: THREE.Camera,
    private prepare: () => void, private finish: () => void) {
    camera.layers.enable(kPoints);
  }

  setClouds(clouds: THREE.Points[]): void {
    this.clouds = clouds.map((points) => ({ points, count: points.geometry.getAttribute("position").count }));
    for (const { points } of this.clouds) points.layers.set(kPoints);
  }

  /// Asks for a new picture; many calls at once make one.
  draw(): void {
    this.isStale = true;
    if (!this.pending) this.pending = requestAnimationFrame(() => this.step());
  }

  /// A whole picture, before this returns.
  drawAll(): void {
    this.begin();
    this.part(1);
  }

  private get total(): number {
    return this.clouds.reduce((sum, { count }) => sum + count, 0);
  }

  private step(): void {
    this.pending = 0;
    if (this.isBusy()) return this.later();
    if (this.isStale) this.begin();
    this.part(Math.min(1, this.drawn + this.budget / Math.max(1, this.total)));
    if (this.drawn < 1) this.later();
  }

  private later(): void {
    this.pending = requestAnimationFrame(() => this.step());
  }

  private begin(): void {
    this.isStale = false;
    this.drawn = 0;
    this.prepare();
    this.renderer.clear();
  }

  private part(end: number): void {
    for (const { points, count } of this.clouds) {
      const first = Math.floor(this.drawn * count);
      points.geometry.setDrawRange(first, Math.floor(end * count) - first);
    }
    // All else is in the first part, and its depths remain.
    if (this.drawn > 0) this.camera.layers.disable(0);
    this.renderer.render(this.scene, this.camera);
    this.camera.layers.enable(0);
    this.inWork = (end - this.drawn) * this.total;
    this.drawn = end;
    this.finish();
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    this.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    this.begun_ms = performance.now();
  }

  /// Whether the last picture is still being drawn. Where it is done, its time tells how many points the next one has.
  private isBusy(): boolean {
    if (!this.fence) return false;
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    if (gl.getSyncParameter(this.fence, gl.SYNC_STATUS) !== gl.SIGNALED) return !gl.isContextLost();
    gl.deleteSync(this.fence);
    this.fence = null;
    const took_ms = performance.now() - this.begun_ms;
    const isFull = this.inWork > 0.9 * this.budget;
    if (took_ms > kSlow_ms) this.budget = Math.max(kLeast, this.budget * Math.max(0.5, kSlow_ms / took_ms));
    else if (took_ms < kQuick_ms && isFull) this.budget *= 1.5;
    return false;
  }
}
