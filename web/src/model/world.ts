// How the axes of the world that the page shows are called.

import type { View } from "./view";

export interface WorldNames {
  x: string;
  y: string;
  up: string; // what points up on a map
  knowsNorth: boolean;
}

/// With a reference the world is the reference's, of which the page knows only that z is up.
export function worldNames(view: View): WorldNames {
  const { run } = view.active.value;
  const reference = run.summary.heading?.reference ?? "";
  if (run.evaluation) return { x: "x (m)", y: "y (m)", up: "the reference's y axis", knowsNorth: false };
  if (!reference.includes("north")) return { x: "x (m)", y: "y (m)", up: "the world's y axis", knowsNorth: false };
  return { x: "east (m)", y: "north (m)", up: reference, knowsNorth: true };
}
