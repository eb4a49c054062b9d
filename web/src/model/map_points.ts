// Points of landmarks and walls on a map, as a picture that is kept until the map changes.

import type { MapFrame } from "../plan/map_frame";
import { nearestPoses, plainColour, pointColours, type Points } from "./points";
import type { Projection } from "./projections";
import type { Track } from "./track";
import type { View } from "./view";

// The first points are spread over all of them. Unrolled, each has to be given to the pose nearest to it.
const kMostFlat = 500_000, kMostUnrolled = 200_000;

/// The walls where they are known and wanted, else the landmarks.
export function shownPoints(view: View, track: Track): Points | null {
  const { landmarks, walls } = view.shown.value;
  return walls && track.walls ? track.walls : landmarks ? track.landmarks : null;
}

/// One pixel a point; `ratio` pixels of the picture to one of the page.
export function pointsPicture(view: View, projection: Projection, frame: MapFrame, width: number, height: number, ratio: number): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  canvas.width = Math.max(1, Math.round(width * ratio));
  canvas.height = Math.max(1, Math.round(height * ratio));
  const context = canvas.getContext("2d", { willReadFrequently: true });
  if (!context) return canvas;
  const picture = context.createImageData(canvas.width, canvas.height);
  for (const track of projection.tracks) {
    const points = shownPoints(view, track);
    if (points) splat(picture, points, track, view, projection, frame, ratio);
  }
  context.putImageData(picture, 0, 0);
  return canvas;
}

function splat(picture: ImageData, points: Points, track: Track, view: View, projection: Projection, frame: MapFrame, ratio: number): void {
  const { xyz } = points;
  const { rgb } = pointColours(points, track, view.pointColouring.value);
  const plain = plainColour();
  const alpha = rgb ? 210 : 95;
  const count = Math.min(xyz.length / 3, projection.isUnrolled ? kMostUnrolled : kMostFlat);
  const nearest = projection.isUnrolled ? nearestOf(track, xyz) : null;
  const size = Math.max(1, Math.round(ratio));
  for (let i = 0; i < count; ++i) {
    const pose = nearest ? nearest[i] : 0;
    if (pose < 0) continue;
    const [u, v] = projection.flat(track, [xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]], pose);
    const x = Math.round(frame.x(u) * ratio), y = Math.round(frame.y(v) * ratio);
    if (x < 0 || y < 0 || x + size > picture.width || y + size > picture.height) continue;
    for (let dy = 0; dy < size; ++dy) {
      for (let dx = 0; dx < size; ++dx) {
        const at = 4 * ((y + dy) * picture.width + x + dx);
        picture.data[at] = rgb ? rgb[3 * i] : plain[0];
        picture.data[at + 1] = rgb ? rgb[3 * i + 1] : plain[1];
        picture.data[at + 2] = rgb ? rgb[3 * i + 2] : plain[2];
        picture.data[at + 3] = Math.min(255, picture.data[at + 3] + alpha);
      }
    }
  }
}

const kNearest = new WeakMap<Float32Array, { track: Track; poses: number; nearest: Int32Array }>();

function nearestOf(track: Track, xyz: Float32Array): Int32Array {
  const kept = kNearest.get(xyz);
  if (kept && kept.track === track && kept.poses === track.position.length) return kept.nearest;
  const nearest = nearestPoses(xyz.subarray(0, 3 * kMostUnrolled), track.position);
  kNearest.set(xyz, { track, poses: track.position.length, nearest });
  return nearest;
}
