// What `lodeline` puts into the page; src/lodeline/output/report/page writes it. Names of columns are those of the CSV files.

export interface Table {
  total: number; // rows of the file; the page may hold fewer
  stride: number; // every so manieth row is here
  t_s: number[]; // since the run's first state
  numbers: Record<string, (number | null)[]>;
  words: Record<string, string[]>;
}

export interface Finding {
  severity: string;
  kind: string;
  message: string;
  count: number;
}

export interface Summary {
  program?: string;
  data?: string;
  rig?: { cameras?: string[]; camera_rate_hz?: number; imu_rate_hz?: number; camera_axis_B?: number[] };
  interrupted?: boolean;
  first_frame_ns?: string; // findings count their times from it
  do_not_trust?: string;
  frames?: number;
  frames_with_pose?: number;
  frames_inertial?: number;
  frames_degraded?: number;
  images_recorded?: number;
  completion?: number;
  path_m?: number;
  duration_s?: number;
  landmarks?: number;
  keyframes?: number;
  mean_tracks?: number;
  mean_reprojection_rms_px?: number;
  real_time_factor?: number;
  core_ms_per_frame?: Record<string, number>;
  peak_memory_MB?: number;
  heading?: { reference?: string; sigma_rad?: number; north_found_after_s?: number; world_turned_rad?: number };
  findings?: Finding[];
}

export interface Picture {
  t_s: number;
  jpeg: string; // base64
}

export interface Statistics {
  rmse: number;
  mean: number;
  median: number;
  max: number;
}

export interface Absolute {
  position_m: Statistics;
  rotation_deg: Statistics;
  yaw_deg: Statistics;
}

export interface Evaluation {
  figures: {
    estimate: { path_m: number };
    reference: { name: string; path_m: number };
    association: { pairs: number };
    alignment: {
      type: string;
      scale: number;
      reference_from_estimate_quaternion_wxyz: number[];
      reference_from_estimate_translation_m: number[];
    };
    absolute: Absolute;
    end_point: { after_alignment_m: number; after_alignment_percent: number; from_equal_starts_percent: number };
    relative?: { length_m: number; translation_percent: Statistics; yaw_deg: Statistics }[];
  };
  yaw_aligned: Absolute | null; // where the figures' alignment turns more than the heading
  errors: Table; // position [m], yaw [deg], rotation [deg]
  path: { t_s: number[]; x: number[]; y: number[]; z: number[] }; // the reference, in its own world
}

export interface Magnetometer {
  table: Table;
  is_calibrated: boolean;
  field_strength_T: number | null; // that corrected readings should have
  field_strength_from: string; // in words
}

/// A pair of keyframes whose images show one place.
export interface Loop {
  new_t_s: number;
  old_t_s: number | null; // null where the old keyframe is of another dive
  old_dive?: string;
  source: string;
  inliers: number;
}

export interface Outcome {
  status: string;
  reason: string;
  count: number;
  t_s: number[]; // of the first ones
}

export interface RunMap {
  pairs: number; // that were compared
  outcomes: Outcome[];
  loops: Loop[]; // accepted
  path: { t_s: number[]; x: number[]; y: number[]; z: number[] } | null; // keyframes in the solved map
  control: { name: string; kind: string; t_s: number; error_m: number[]; chi_squared: number; is_blunder: boolean }[];
}

/// Points in steps from the lowest corner of the box around them.
export interface Cloud {
  total: number; // of the file; the page may hold fewer
  low_m: [number, number, number];
  step_m: [number, number, number];
  xyz: string; // base64 of 16-bit numbers, little endian: x y z x y z ...
  rgb: string; // base64 of bytes; empty where no colours are known
}

/// A station of the survey that `lodeline export` makes of the run.
export interface Station {
  t_s: number;
  left_right_up_down_m: (number | null)[];
  splays_m: [number, number, number][]; // from the station, in the run's world
}

/// The same dive by another method; the states hold poses and, but for the map, their uncertainty.
export interface Solution {
  kind: "run" | "map";
  states: Table;
}

/// What is drawn underneath the plan, in the world of the page's runs.
export interface Background {
  name: string;
  lines: [number, number][][]; // x and y, m
  image: { type: string; data: string; column_m: [number, number]; row_m: [number, number]; first_m: [number, number] } | null;
}

export interface Run {
  name: string;
  origin_ns: string;
  is_refined?: boolean; // states, landmarks and evaluation are of the batch solution
  summary: Summary;
  config: string;
  states: Table;
  landmarks: Cloud;
  others: Solution[];
  walls: Cloud | null;
  stations: Station[] | null;
  pictures: Picture[];
  timings: Table | null;
  magnetometer: Magnetometer | null;
  evaluation: Evaluation | null;
  map: RunMap | null;
}

export interface PageData {
  live: boolean;
  runs: Run[]; // none while live
  name?: string; // these while live
  data?: string;
  camera_axis_B?: number[];
  background?: Background | null;
}

export function readPageData(): PageData {
  const text = document.getElementById("lodeline-data")?.textContent ?? "";
  return JSON.parse(text) as PageData;
}

export function decodeFloats(base64: string): Float32Array {
  return new Float32Array(decodeBytes(base64).buffer);
}

export function decodeBytes(base64: string): Uint8Array {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

export function column(table: Table, name: string): (number | null)[] | null {
  const values = table.numbers[name];
  return values && values.some((v) => v !== null) ? values : null;
}

/// Index of the value in a rising list that is nearest to `t`.
export function nearestIndex(times: number[], t: number): number {
  let low = 0;
  let high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle;
    else high = middle;
  }
  return high > 0 && Math.abs(times[high] - t) < Math.abs(times[low] - t) ? high : Math.max(low, 0);
}

/// Errors of attitude as they are shown: free of what an alignment of positions alone leaves undetermined.
export function attitudeErrors(evaluation: Evaluation): Absolute {
  return evaluation.yaw_aligned ?? evaluation.figures.absolute;
}
