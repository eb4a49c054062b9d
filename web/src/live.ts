// The page while a run goes on: what the program tells over server-sent events, shown as it comes.

import { decodeFloats, type PageData, type Run, type RunMap } from "./model/data";
import { append, element, section, toggle } from "./base/dom";
import { headingDial } from "./plots/heading_dial";
import { number } from "./base/format";
import { kPlots } from "./plots/plots";
import { plotCard } from "./plots/plot";
import { statusCard } from "./plots/status_strip";
import type { Vec3 } from "./base/geometry";
import { appendPose, makeTracks, refill, type Track } from "./model/track";
import { trajectorySection } from "./trajectory_section";
import { View } from "./model/view";
import { turnNumbers, turnPoints, turnRows } from "./model/world_turn";

/// The pose in the map, and the turn of the odometry's world in it about the vertical.
interface MapPose {
  x_m: number;
  y_m: number;
  z_m: number;
  turned_rad: number;
}

/// What LiveView sends of a frame; columns have the names of states.csv.
interface State {
  t_s: number;
  numbers?: Record<string, number | null>;
  words: Record<string, string>;
  map?: MapPose; // where a place of the map is known
  landmarks?: string; // new ones, base64 of 32-bit floats: x y z x y z ...
  run: { frames: number; path_m: number; real_time_factor: number; heading_reference: string;
    north_from_world_rad: number | null; waiting_for: string };
}

const kRedraw_ms = 500;
const kMostPictures = 40;
const kMostLandmarks = 60000;
const kWorthTurning_rad = 0.002; // north moves a little with every frame
const kLivePlots = ["heading", "depth", "heading-sigma", "tracks"];

/// The way in the map alone; the ledger is in the report.
function emptyMap(): RunMap {
  return { pairs: 0, outcomes: [], loops: [], path: { t_s: [], x: [], y: [], z: [] }, control: [] };
}

function emptyRun(data: PageData): Run {
  const run: Run = {
    name: data.name ?? "run", origin_ns: "0", config: "", evaluation: null, timings: null, magnetometer: null, map: emptyMap(), pictures: [],
    summary: { data: data.data, rig: { camera_axis_B: data.camera_axis_B }, heading: {} },
    states: { total: 0, stride: 1, t_s: [], numbers: {}, words: { status: [], magnetometer: [] } },
    landmarks: { total: 0, low_m: [0, 0, 0], step_m: [0, 0, 0], xyz: "", rgb: "" }, others: [], walls: null, stations: null,
  };
  for (const name of ["p_x [m]", "p_y [m]", "p_z [m]", "q_w", "q_x", "q_y", "q_z", "sigma_p_x [m]", "sigma_p_y [m]", "sigma_p_z [m]",
    "sigma_heading [rad]", "tracks", "landmarks", "reprojection_rms [sigma]"]) run.states.numbers[name] = [];
  return run;
}

function metres(position: (number | null)[]): string {
  return `${position.map((v) => (v ?? NaN).toFixed(2).replace(/^-(?=[0.]*$)/, "").replace("-", "−")).join(", ")} m`;
}

/// The newest words and figures.
function nowPanel(): { node: HTMLElement; show: (state: State, mapPoints: number) => void } {
  const dial = headingDial();
  const list = element("dl", "figures");
  const word = element("strong", "status-word", "connecting");
  const show = (state: State, mapPoints: number) => {
    const { run, words, numbers } = state;
    word.textContent = words.status === "waiting" ? `waiting for ${run.waiting_for}` : words.status;
    word.dataset.status = words.status;
    const rows: [string, string][] = [
      ["Time", `${number(state.t_s, 4)} s, frame ${run.frames}`],
      ["Ratio to real time", `${number(run.real_time_factor, 3)} ×`],
      ["Path", `${number(run.path_m, 4)} m`],
      ["Tracks", numbers ? `${numbers["tracks"]}, ${numbers["landmarks"]} of them landmarks` : "–"],
      ["Map points shown", String(mapPoints)],
      ["By odometry", numbers ? metres(["x", "y", "z"].map((axis) => numbers[`p_${axis} [m]`])) : "–"],
      ...(state.map ? [["In the map", metres([state.map.x_m, state.map.y_m, state.map.z_m])] as [string, string]] : []),
      ["Magnetometer", words.magnetometer],
    ];
    list.replaceChildren(...rows.flatMap(([name, value]) => [element("dt", "", name), element("dd", "", value)]));
  };
  return {
    node: element("article", "card now", element("div", "now-text", word, list), dial.node),
    show: (state, mapPoints) => {
      show(state, mapPoints);
      dial.show(state);
    },
  };
}

export function startLive(page: Element, data: PageData): void {
  const run = emptyRun(data);
  const [track] = makeTracks(run);
  const view = new View([[track]]);
  const now = nowPanel();
  let landmarks: number[] = []; // x y z x y z ...
  let turned_rad = 0; // what is shown, against the run's own world
  let follow = true;
  let dirty = false;
  append(now.node, toggle("Follow the newest pose", true, (on) => (follow = on)));
  view.shown.set({ ...view.shown.value, pictures: false }); // of the last seconds only
  document.title = `${run.name} – Lodeline, live`;
  append(page,
    element("header", "head", element("p", "mark", "Lodeline live"), element("h1", "", run.name), element("p", "from", run.summary.data ?? "")),
    now.node, trajectorySection(view),
    section("plots", "Over time", element("div", "grid",
      statusCard(view, "status", "Status", [{ name: "images", column: "status" }, { name: "magnetometer", column: "magnetometer" }]),
      ...kPlots.filter((spec) => kLivePlots.includes(spec.id)).map((spec) => plotCard(view, spec.make)))));

  const events = new EventSource("events");
  events.addEventListener("state", (event) => {
    const state = JSON.parse((event as MessageEvent<string>).data) as State;
    // After a broken connection the server tells everything from the start again.
    if (state.t_s <= (run.states.t_s[run.states.t_s.length - 1] ?? -1)) return;
    turnMapPath(track, state);
    const north_rad = state.run.north_from_world_rad ?? turned_rad;
    if (Math.abs(north_rad - turned_rad) > kWorthTurning_rad) {
      turnRows(run.states, north_rad - turned_rad);
      landmarks = turnPoints(landmarks, north_rad - turned_rad);
      turned_rad = north_rad;
      refill(track);
    }
    if (state.numbers) turnNumbers(state.numbers, turned_rad);
    add(run, state);
    if (state.numbers) appendPose(track, run.states.t_s.length - 1);
    if (state.map) track.inMap.push([state.map.x_m, state.map.y_m, state.map.z_m]);
    run.summary.heading = { reference: state.run.heading_reference };
    if (state.landmarks) landmarks = added(landmarks, turnPoints(decodeFloats(state.landmarks), turned_rad));
    now.show(state, landmarks.length / 3);
    dirty = true;
  });
  events.addEventListener("picture", (event) => {
    run.pictures.push(JSON.parse((event as MessageEvent<string>).data));
    if (run.pictures.length > kMostPictures) run.pictures.shift();
    dirty = true;
  });
  events.addEventListener("end", () => {
    events.close();
    append(now.node, element("p", "note ended", "The run has ended; report.html in its folder shows all of it."));
  });
  setInterval(() => {
    if (!dirty || track.t_s.length === 0) return;
    dirty = false;
    track.landmarks = { xyz: Float32Array.from(landmarks), rgb: null };
    view.active.emit();
    if (follow) view.time.set(track.t_s[track.t_s.length - 1]);
  }, kRedraw_ms);
}

/// Until a loop moves it, the map turns to north with the odometry; so does the way that is drawn of it.
function turnMapPath(track: Track, { map, numbers }: State): void {
  if (!map || !numbers) return;
  const turned = turnPoints(["x", "y", "z"].map((axis) => numbers[`p_${axis} [m]`] ?? NaN), map.turned_rad);
  const moved_m = Math.hypot(map.x_m - turned[0], map.y_m - turned[1], map.z_m - turned[2]);
  const turn_rad = map.turned_rad - track.mapTurned_rad;
  if (moved_m > 0.01 || Math.abs(turn_rad) < kWorthTurning_rad) return;
  track.mapTurned_rad = map.turned_rad;
  track.inMap = track.inMap.map((p) => turnPoints(p, turn_rad) as Vec3);
}

/// When there are many, every second one goes.
function added(landmarks: number[], more: number[]): number[] {
  landmarks.push(...more);
  return landmarks.length < 3 * kMostLandmarks ? landmarks : landmarks.filter((_, i) => Math.floor(i / 3) % 2 === 0);
}

function add(run: Run, state: State): void {
  const { states } = run;
  states.total += 1;
  states.t_s.push(state.t_s);
  for (const [name, column] of Object.entries(states.numbers)) column.push(state.numbers?.[name] ?? null);
  for (const [name, column] of Object.entries(states.words)) column.push(state.words[name] ?? "none");
}
