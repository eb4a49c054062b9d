// The magnetometer's readings on the sphere that they should fill.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { sequential, themed, whenThemeChanges } from "../base/colours";
import { element, whenNear, whenResized } from "../base/dom";
import { number } from "../base/format";
import type { Magnetometer } from "../model/data";
import { printablePicture } from "../base/vector";
import type { View } from "../model/view";

interface Cloud {
  points: Float32Array; // uT
  off: number[]; // how far each is from the sphere, share of its radius
  radius_uT: number;
  nearest: number; // of the readings to the middle, share of the radius
}

/// Readings of a stage ("read" or "corrected"); the sphere has the field's known size, or the readings' mean.
function cloud(magnetometer: Magnetometer, stage: string): Cloud {
  const { table } = magnetometer;
  const columns = ["x", "y", "z"].map((axis) => table.numbers[`${stage}_${axis} [T]`]);
  const points: number[] = [];
  for (let i = 0; i < table.t_s.length; ++i) {
    if (columns.some((c) => c[i] === null)) continue;
    points.push(...columns.map((c) => 1e6 * (c[i] as number)));
  }
  const norms = Array.from({ length: points.length / 3 }, (_, i) => Math.hypot(points[3 * i], points[3 * i + 1], points[3 * i + 2]));
  const mean = norms.reduce((a, b) => a + b, 0) / Math.max(1, norms.length);
  const radius_uT = magnetometer.field_strength_T ? 1e6 * magnetometer.field_strength_T : mean;
  return { points: new Float32Array(points), off: norms.map((v) => Math.abs(v - radius_uT) / radius_uT), radius_uT,
    nearest: Math.min(...norms) / radius_uT };
}

/// Off by this much of the field or more has the last colour; the gate on the norm is of this size.
const kGreatestOff = 0.05;

/// Made once it comes into sight, and gone where there is no WebGL; the view in space says so.
export function sphereCard(view: View): HTMLElement {
  const drawing = element("div", "sphere");
  const note = element("p", "note");
  const card = element("article", "card", element("header", "", element("h3", "", "Field in body axes")), drawing, note);
  whenNear(card, () => {
    try {
      draw(view, card, drawing, note);
    } catch {
      card.remove();
    }
  });
  return card;
}

function draw(view: View, card: HTMLElement, drawing: HTMLElement, note: HTMLElement): void {
  const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
  renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
  drawing.append(renderer.domElement);
  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(35, 1, 0.1, 20);
  camera.up.set(0, 0, 1);
  camera.position.set(2.4, -2.6, 1.5);
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.enableZoom = false;
  const render = () => renderer.render(scene, camera);
  controls.addEventListener("change", render);
  const rebuild = () => {
    const { magnetometer } = view.active.value.run;
    card.hidden = !magnetometer;
    scene.clear();
    if (!magnetometer) return;
    const corrected = cloud(magnetometer, "corrected");
    scene.add(globe(Math.min(1, corrected.nearest)), dots(corrected));
    const rms = Math.sqrt(corrected.off.reduce((a, v) => a + v * v, 0) / Math.max(1, corrected.off.length));
    note.textContent = (magnetometer.is_calibrated ? "Readings after calibration" : "Readings as they are: no calibration was given") +
      `; sphere: ${number(corrected.radius_uT)} µT, ${magnetometer.field_strength_from}. ` +
      `RMS distance ${number(100 * rms, 2)} % of it. Yellow and green dots lie on it, violet ones ${100 * kGreatestOff} % or more off.`;
    render();
  };
  view.active.watch(rebuild);
  whenThemeChanges(rebuild);
  printablePicture(drawing, renderer.domElement, rebuild);
  whenResized(drawing, (width, height) => {
    if (width === 0 || height === 0) return;
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    renderer.setSize(width, height);
    render();
  });
}

function globe(inner: number): THREE.Object3D {
  const lines = new THREE.EdgesGeometry(new THREE.SphereGeometry(0.995, 24, 12).rotateX(Math.PI / 2), 1);
  const group = new THREE.Group();
  group.add(new THREE.LineSegments(lines, new THREE.LineBasicMaterial({ color: themed("grid-strong"), transparent: true, opacity: 0.6 })));
  // Hides the far side, so that it is seen which dots are in front.
  group.add(new THREE.Mesh(new THREE.SphereGeometry(0.97 * inner, 48, 24),
    new THREE.MeshBasicMaterial({ color: themed("surface"), transparent: true, opacity: 0.82 })));
  return group;
}

function dots({ points, off, radius_uT }: Cloud): THREE.Object3D {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(points.map((v) => v / radius_uT), 3));
  const colours = off.flatMap((v) => {
    const [r, g, b] = sequential(1 - Math.min(1, v / kGreatestOff));
    const colour = new THREE.Color().setRGB(r / 255, g / 255, b / 255, THREE.SRGBColorSpace);
    return [colour.r, colour.g, colour.b];
  });
  geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(colours), 3));
  return new THREE.Points(geometry,
    new THREE.PointsMaterial({ vertexColors: true, size: 3 * Math.min(2, devicePixelRatio), sizeAttenuation: false }));
}
