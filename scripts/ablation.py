#!/usr/bin/env python3
"""Measures what each mechanism of the estimator is worth.

Runs a fixed set of dives with the default settings and with each mechanism switched off, and prints a table: geometric
means over the dives of error without the mechanism / error with it, in position and rotation. A value above 1 means that
the mechanism helps. The dives have three IMUs, clean and field realism, and two cameras or one. A real recording is added if
there is one.

    ablation.py WORK [--program build/release/bin/lodeline] [--only NAME ...] [--jobs N] [--markdown FILE]

WORK keeps rendered dives and is the output of `lodeline batch`: a second call makes only the runs that are missing.
"""

import argparse
import math
import os
import re
import subprocess
import sys
from pathlib import Path

from batch_runs import run_batch

ROOT = Path(__file__).resolve().parent.parent
SECONDS = 40
# Scenario, IMU and seed of each pair of dives (clean, field).
RIGS = [("cave1_short", "gx5-25", 7103), ("dos_ojos", "gv7", 7211), ("demo", "consumer", 7307)]

# Mechanism, settings that switch it off, and whether it needs the magnetometer.
MECHANISMS = [
    ("landmark linearization cache", ["window.frozen_frames=0"], False),
    ("intrinsics model selection", ["camera_calibration.trust_confirmed_files=false"], False),
    ("intrinsics as states", ["camera_calibration.intrinsics=false"], False),
    ("camera calibration as states", ["camera_calibration.enabled=false"], False),
    ("rotation learned from stereo matches", ["front_end.learn_stereo_rotation=false"], False),
    ("track weights", ["solver.track_weights=false"], False),
    ("interpolated frames", ["window.interpolated_gap_s=0"], False),
    ("split tracks", ["window.split_at_keyframe=0"], False),
    ("axes of the IMU as states", ["inertial.gyroscope_axes_sigma=0", "inertial.accelerometer_axes_sigma=0"], False),
    ("zero-velocity update", ["zero_velocity.enabled=false"], False),
    ("static image mask", ["front_end.static_image_mask=false"], False),
    ("water density prior", ["pressure.water_density_prior=false"], False),
    ("magnetometer", ["magnetometer.model=off"], True),
    ("Student weights of the field", ["magnetometer.student_dof=1e6"], True),
    ("magnetic step detector", ["magnetometer.step.enabled=false"], True),
    ("dip and norm gate", ["magnetometer.gate.max_norm_error=1", "magnetometer.gate.max_dip_error_rad=3"], True),
]


def call(command):
    result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode not in (0, 3):
        sys.exit(f"{' '.join(map(str, command))}: exit code {result.returncode}\n{result.stderr[-2000:]}")


def render(program, work):
    """Renders the dives that are missing. Returns (name, folder, calibration of the magnetometer) of each."""
    recordings = []
    for scenario, imu, seed in RIGS:
        for realism in ("clean", "field"):
            name = f"{scenario}_{imu}_{realism}"
            folder, waving = work / "dives" / name, work / "dives" / f"{name}_waving"
            common = ["--realism", realism, "--seed", seed, "--imu", imu, "--quiet"]
            if not (folder / "finished").exists():
                print("rendering", name, flush=True)
                call([program, "simulate", scenario, "--seconds", SECONDS, "--width", 480, "--camera-rate-hz", 12,
                      "-o", folder, *common] | Text())
                call([program, "simulate", "figure_eight", "--no-images", "-o", waving, *common] | Text())
                call([program, "calibrate", "magnetometer", waving, "-o", folder / "magnetometer.yaml"] | Text())
                (folder / "finished").touch()
            recordings.append((name, folder, folder / "magnetometer.yaml"))
    real = Path(os.environ.get("LODELINE_DATA_DIR", ROOT / "../shared/data")) / "euroc_mh01_stereo_14s"
    if (real / "mav0").exists():
        recordings.append(("real", real, None))
    return recordings


class Text:
    """`list | Text()` is the list with all of its members as text."""

    def __ror__(self, command):
        return [str(part) for part in command]


def variant(name, cameras):
    return re.sub("[^a-z0-9]+", "_", name.lower()) + ("_left" if cameras == 1 else "_stereo")


def measure(program, work, recordings, mechanisms, jobs):
    """Runs all recordings without each mechanism by `lodeline batch`. Returns position (m) and rotation (deg) errors by the
    names of recording and variant."""
    variants = [{"name": variant(name, cameras), "set": settings + (["source.cameras=[0]"] if cameras == 1 else [])}
                for name, settings in mechanisms for cameras in (2, 1)]
    listed = {"args": ["--no-report"], "variants": variants,
              "recordings": [{"name": name, "data": str(folder.resolve()), "truth": str(folder.resolve()),
                              "args": ["--mag-calibration", str(calibration.resolve())] if calibration else []}
                             for name, folder, calibration in recordings]}
    rows = run_batch(program, work, listed, jobs).values()
    if any(not row["position_rmse_m"] for row in rows):
        sys.exit(f"{work}/table.md says which runs have no errors")
    return {(row["recording"], row["variant"]): (float(row["position_rmse_m"]), float(row["rotation_rmse_deg"]))
            for row in rows}


def geometric_mean(values):
    return math.exp(sum(map(math.log, values)) / len(values))


def row(cells):
    return "| " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("work", type=Path)
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/bin/lodeline")
    parser.add_argument("--only", nargs="*", help="mechanisms to measure")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--markdown", type=Path, help="file for the table")
    arguments = parser.parse_args()
    recordings = render(arguments.program, arguments.work)
    chosen = [mechanism for mechanism in MECHANISMS if not arguments.only or mechanism[0] in arguments.only]
    references = {False: "no magnetometer", True: "default"}
    tried = {"no magnetometer": ["magnetometer.model=off"], "default": []}
    for name, settings, magnetic in chosen:
        tried[name] = settings if magnetic else ["magnetometer.model=off", *settings]
    errors = measure(arguments.program, arguments.work, recordings, tried.items(), arguments.jobs)
    columns = ["mechanism left out", "position, ratio", "rotation, ratio", "worst position", "worst rotation"]
    lines = [row(columns), row(["---"] * len(columns))]
    for name, _, magnetic in chosen:
        pairs = [(errors[dive, variant(name, cameras)], errors[dive, variant(references[magnetic], cameras)])
                 for dive, *_ in recordings for cameras in (2, 1)]
        ratios = [[without[i] / reference[i] for without, reference in pairs] for i in range(2)]
        means, worst = [f"{geometric_mean(r):.3f}" for r in ratios], [f"{max(r):.2f}" for r in ratios]
        lines.append(row([name, *means, *worst]))
        print(lines[-1], flush=True)
        if arguments.markdown:
            arguments.markdown.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
