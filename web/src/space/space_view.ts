// The 3-D view: camera, mouse and fingers, what is drawn when.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { ViewHelper } from "three/addons/helpers/ViewHelper.js";
import { whenThemeChanges } from "../base/colours";
import { element, whenResized } from "../base/dom";
import { GradualDrawing, hasGraphicsCard } from "./gradual_drawing";
import { shownPoints } from "../model/map_points";
import { grid, loopLines, mapLine, measureLine, otherLine, pointCloud, placeOf, PoseMarker, referenceLine, solutionLine, trajectoryLine, type Place } from "./scene";
import { poseText, Tip } from "../plan/tip";
import { poseAt, type Track } from "../model/track";
import { printablePicture } from "../base/vector";
import type { View } from "../model/view";
import { worldNames } from "../model/world";

const kPick_px = 18;

export class SpaceView {
  readonly node = element("div", "space");
  private renderer: THREE.WebGLRenderer;
  private scene = new THREE.Scene();
  private camera = new THREE.PerspectiveCamera(45, 1, 0.01, 1000);
  private controls: OrbitControls;
  private content = new THREE.Group();
  private marker!: PoseMarker;
  private place: Place;
  private scaleNote = element("p", "note");
  private tip = new Tip();
  private compass: ViewHelper;
  private drawing: GradualDrawing;
  private isStale = true; // what is drawn has to be made anew
  private sized = false;
  private measured: THREE.Object3D | null = null;

  /// Throws where the browser has no WebGL.
  constructor(private view: View) {
    this.renderer = new THREE.WebGLRenderer({ antialias: hasGraphicsCard(), alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.place = placeOf(view.tracks);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => this.draw());
    this.scene.add(this.content);
    this.renderer.autoClear = false; // the compass is drawn over the scene
    this.compass = new ViewHelper(this.camera, this.renderer.domElement);
    this.drawing = new GradualDrawing(this.renderer, this.scene, this.camera, () => this.prepare(), () => this.compass.render(this.renderer));
    this.node.append(this.renderer.domElement, this.scaleNote, this.tip.node);
    this.lookFrom("oblique");
    whenResized(this.node, (width, height) => this.resize(width, height));
    view.active.watch(() => this.rebuild());
    view.colouring.watch(() => this.rebuild());
    view.pointColouring.watch(() => this.rebuild());
    view.mark.watch(() => this.draw());
    view.shown.watch(() => this.rebuild());
    view.time.watch(() => this.draw());
    whenThemeChanges(() => this.rebuild());
    this.node.addEventListener("click", (event) => {
      const pose = this.nearest(event);
      if (pose >= 0) view.time.set(view.active.value.t_s[pose]);
    });
    this.node.addEventListener("pointermove", (event) => this.hover(event));
    this.node.addEventListener("pointerleave", () => this.tip.hide());
    printablePicture(this.node, this.renderer.domElement, () => {
      this.rebuild();
      this.drawing.drawAll();
    });
  }

  get canvas(): HTMLCanvasElement {
    this.drawing.drawAll();
    return this.renderer.domElement;
  }

  lookFrom(where: "oblique" | "top" | "side"): void {
    this.place = placeOf(this.view.tracks);
    const { middle, radius, reach } = this.place;
    const away = { oblique: [-0.55, -0.95, 0.75], top: [0, -0.001, 1], side: [0, -1, 0.02] }[where];
    const distance = (1.05 * reach) / Math.sin((0.5 * this.camera.fov * Math.PI) / 180) / Math.min(1, this.camera.aspect);
    const direction = new THREE.Vector3(...away).normalize();
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(direction, distance);
    this.camera.near = radius / 500;
    this.camera.far = radius * 200;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  /// A run that goes on outgrows the view; then it moves back, looking the same way.
  private refit(): void {
    const place = placeOf(this.view.tracks);
    const growth = place.reach / this.place.reach;
    if (growth < 1.15) return;
    this.place = place;
    const away = this.camera.position.clone().sub(this.controls.target).multiplyScalar(growth);
    this.controls.target.copy(place.middle);
    this.camera.position.copy(place.middle).add(away);
    this.camera.far = Math.max(this.camera.far, 200 * place.radius);
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  private resize(width: number, height: number): void {
    if (width === 0 || height === 0) return;
    const first = !this.sized;
    this.sized = true;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.renderer.setSize(width, height);
    if (first) this.lookFrom("oblique");
    this.draw();
  }

  /// Many changes at once make the content anew once, before the next picture.
  private rebuild(): void {
    this.isStale = true;
    this.draw();
  }

  private makeContent(): void {
    this.isStale = false;
    const { view } = this;
    this.content.traverse((object) => {
      const drawable = object as THREE.Mesh;
      drawable.geometry?.dispose();
      (drawable.material as THREE.Material | undefined)?.dispose?.();
    });
    this.content.clear();
    this.refit();
    const track = view.active.value;
    if (track.position.length > 1) this.content.add(trajectoryLine(track, view.colouring.value));
    view.tracks.forEach((other, i) => {
      if (other !== track && other.position.length > 1) this.content.add(otherLine(other, i));
    });
    const clouds = view.tracks.flatMap((each) => {
      const points = shownPoints(view, each);
      return points ? [pointCloud(points, each, view.pointColouring.value)] : [];
    });
    if (clouds.length > 0) this.content.add(...clouds);
    this.drawing.setClouds(clouds);
    const reference = view.shown.value.reference && track.kind !== "map" ? referenceLine(track) : null;
    if (reference) this.content.add(reference);
    if (view.shown.value.others) for (const other of view.others()) if (other.position.length > 1) this.content.add(solutionLine(other));
    const inMap = view.shown.value.others && track.kind !== "map" ? mapLine(track) : null;
    if (inMap) this.content.add(inMap);
    if (view.shown.value.loops && track.run.map?.loops.length) this.content.add(loopLines(track));
    this.addGround();
    this.marker = new PoseMarker(0.06 * this.place.radius);
    this.content.add(this.marker.object);
  }

  private addGround(): void {
    const { middle, radius } = this.place;
    const lowest = Math.min(...this.view.tracks.flatMap((t) => t.position.map((p) => p[2])), middle.z) - 0.15 * radius;
    const { object, step_m } = grid(this.place, lowest);
    this.content.add(object);
    const names = worldNames(this.view);
    this.compass.setLabels(...(names.knowsNorth ? (["E", "N", "up"] as const) : (["x", "y", "z"] as const)));
    this.scaleNote.textContent =
      `Meshes of ${step_m} m.${names.knowsNorth ? ` N: ${names.up}.` : ""} Drag to turn, wheel or pinch to zoom, click for a pose.`;
  }

  private hover(event: PointerEvent): void {
    const pose = event.buttons === 0 ? this.nearest(event) : -1;
    if (pose < 0) return this.tip.hide();
    const box = this.node.getBoundingClientRect();
    this.tip.show(poseText(this.view, pose), event.clientX - box.left, event.clientY - box.top, box.width);
  }

  /// The pose that is drawn nearest to the pointer; −1 where none is near.
  private nearest(event: MouseEvent): number {
    const box = this.renderer.domElement.getBoundingClientRect();
    const track = this.view.active.value;
    const p = new THREE.Vector3();
    let best = kPick_px;
    let chosen = -1;
    track.position.forEach((position, i) => {
      p.set(...position).project(this.camera);
      if (p.z > 1) return;
      const x = box.left + (0.5 + p.x / 2) * box.width;
      const y = box.top + (0.5 - p.y / 2) * box.height;
      const distance = Math.hypot(x - event.clientX, y - event.clientY);
      if (distance < best) {
        best = distance;
        chosen = i;
      }
    });
    return chosen;
  }

  private draw(): void {
    this.drawing.draw();
  }

  private prepare(): void {
    if (this.isStale) this.makeContent();
    const track = this.view.active.value;
    const pose = this.view.pose();
    if (this.marker) {
      this.marker.object.visible = track.position.length > 0;
      if (track.position.length > 0) {
        const distance = this.camera.position.distanceTo(new THREE.Vector3(...track.position[pose]));
        this.marker.show(track.position[pose], track.view[pose], 0.075 * distance);
      }
    }
    this.drawMeasure(track, pose);
  }

  private drawMeasure(track: Track, pose: number): void {
    if (this.measured) this.scene.remove(this.measured);
    this.measured = null;
    if (this.view.mark.value === null || track.position.length === 0) return;
    const from = poseAt(track, this.view.mark.value);
    if (from === pose) return;
    this.measured = measureLine(track.position[from], track.position[pose]);
    this.scene.add(this.measured);
  }
}
