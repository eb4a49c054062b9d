// The things that stand in the 3-D view.

import * as THREE from "three";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { kKinds, kLoopColour, kMapColour, themed } from "../base/colours";
import { colourScale, type Colouring } from "../model/colouring";
import { niceStep } from "../base/format";
import type { Vec3 } from "../base/geometry";
import { pointColours, type PointColouring, type Points } from "../model/points";
import { extent, loopEnds, type Track } from "../model/track";

export type Place = { middle: THREE.Vector3; radius: number; reach: number };

export function placeOf(tracks: Track[]): Place {
  const { middle, radius, reach } = extent(tracks);
  return { middle: new THREE.Vector3(...middle), radius, reach };
}

function fatLine(points: Vec3[], colours: number[] | string, width: number, order: number): Line2 {
  const geometry = new LineGeometry();
  geometry.setPositions(points.flat());
  const coloured = typeof colours !== "string";
  if (coloured) geometry.setColors(colours);
  const material = new LineMaterial({
    color: coloured ? 0xffffff : colours, vertexColors: coloured, linewidth: width,
    // A way through a cave is seen through its walls, which are drawn with the transparent things, too.
    depthTest: false, transparent: true,
  });
  const line = new Line2(geometry, material);
  line.renderOrder = order;
  return line;
}

export function trajectoryLine(track: Track, colouring: Colouring): THREE.Object3D {
  const scale = colourScale(track, colouring);
  const grey = new THREE.Color(themed("faint"));
  const colours = scale.colours.flatMap((rgb) => {
    const colour = rgb ? new THREE.Color().setRGB(rgb[0] / 255, rgb[1] / 255, rgb[2] / 255, THREE.SRGBColorSpace) : grey;
    return [colour.r, colour.g, colour.b];
  });
  return fatLine(track.position, colours, 4.5, 2);
}

export function otherLine(track: Track, index: number): THREE.Object3D {
  return fatLine(track.position, kKinds[index % kKinds.length], 2, 1);
}

export function referenceLine(track: Track): THREE.Object3D | null {
  const path = track.run.evaluation?.path;
  if (!path || path.x.length < 2) return null;
  return fatLine(path.x.map((x, i) => [x, path.y[i], path.z[i]] as Vec3), themed("ink"), 1.1, 3);
}

/// Another solution of the same run.
export function solutionLine(track: Track): THREE.Object3D {
  return fatLine(track.position, themed("muted"), 1.4, 1);
}

/// The line that is measured.
export function measureLine(from: Vec3, to: Vec3): THREE.Object3D {
  return fatLine([from, to], themed("accent"), 1.8, 5);
}

/// The way in the map, closed by loops.
export function mapLine(track: Track): THREE.Object3D | null {
  return track.inMap.length > 1 ? fatLine(track.inMap, kMapColour, 1.8, 3) : null;
}

/// A line for each loop between the poses that it joins; a dot where the old keyframe is of another dive.
export function loopLines(track: Track): THREE.Object3D {
  const group = new THREE.Group();
  const ends = loopEnds(track);
  const lines = new THREE.BufferGeometry().setFromPoints(ends.flat().map((p) => new THREE.Vector3(...p)));
  const paint = { color: kLoopColour, depthTest: false, transparent: true };
  group.add(new THREE.LineSegments(lines, new THREE.LineBasicMaterial(paint)));
  const dots = new THREE.BufferGeometry().setFromPoints(ends.map(([, p]) => new THREE.Vector3(...p)));
  group.add(new THREE.Points(dots, new THREE.PointsMaterial({ ...paint, size: 5, sizeAttenuation: false })));
  for (const object of group.children) object.renderOrder = 4;
  return group;
}

const kDense = 300_000;

/// Bytes of a colour as the graphics take them.
function linear(rgb: Uint8Array): Uint8Array {
  const table = Uint8Array.from({ length: 256 }, (_, i) => Math.round(255 * new THREE.Color().setRGB(i / 255, 0, 0, THREE.SRGBColorSpace).r));
  return rgb.map((v) => table[v]);
}

export function pointCloud(points: Points, track: Track, colouring: PointColouring): THREE.Points {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(points.xyz, 3));
  const { rgb } = pointColours(points, track, colouring);
  if (rgb) geometry.setAttribute("color", new THREE.BufferAttribute(linear(rgb), 3, true));
  const isDense = points.xyz.length / 3 > kDense;
  const material = new THREE.PointsMaterial({
    color: rgb ? 0xffffff : themed("landmark"), vertexColors: rgb !== null, sizeAttenuation: false,
    size: (isDense ? 1 : 1.6) * Math.min(2, window.devicePixelRatio),
    // Blending of millions of points takes long without a graphics card.
    transparent: !isDense, opacity: isDense ? 1 : rgb ? 0.85 : 0.55, depthWrite: isDense,
  });
  return new THREE.Points(geometry, material);
}

/// A lattice under everything, its meshes a round number of metres wide.
export function grid(place: Place, low_z: number): { object: THREE.Object3D; step_m: number } {
  const step_m = niceStep(place.radius / 2);
  const cells = 2 * Math.ceil((1.3 * place.radius) / step_m);
  const object = new THREE.GridHelper(cells * step_m, cells, themed("grid-strong"), themed("grid"));
  object.rotation.x = Math.PI / 2;
  object.position.set(
    Math.round(place.middle.x / step_m) * step_m, Math.round(place.middle.y / step_m) * step_m, low_z);
  return { object, step_m };
}

/// The selected pose: a ball, and a pyramid that shows where the camera looks.
export class PoseMarker {
  readonly object = new THREE.Group();

  constructor(private size: number) {
    const material = new THREE.MeshBasicMaterial({ color: themed("accent") });
    const ball = new THREE.Mesh(new THREE.SphereGeometry(0.16 * size, 16, 12), material);
    const cone = new THREE.Mesh(new THREE.ConeGeometry(0.42 * size, size, 4, 1, true),
      new THREE.MeshBasicMaterial({ color: themed("accent"), transparent: true, opacity: 0.4, side: THREE.DoubleSide }));
    cone.geometry.rotateY(Math.PI / 4).translate(0, -0.5 * size, 0).rotateX(Math.PI);
    this.object.add(ball, cone);
    this.object.renderOrder = 4;
  }

  show(position: Vec3, view: Vec3, scale: number): void {
    this.object.position.set(...position);
    const direction = new THREE.Vector3(...view).normalize();
    this.object.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), direction);
    this.object.scale.setScalar(scale / this.size);
  }
}
