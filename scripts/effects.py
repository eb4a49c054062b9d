#!/usr/bin/env python3
"""Measures what each effect of the simulator costs the estimator.

Renders dives with the effects of `clean`, the same with each further effect alone, and with all of them together, in
stereo. Runs `lodeline run` on each with both cameras and with one, and prints a table. With several seeds, drift, scale and
position are root mean squares, and the other figures are those of all poses together.

    effects.py WORK [--program build/release/bin/lodeline] [--only EFFECT ...] [--seeds N] [--seconds S] [--jobs N]
               [--markdown FILE]

WORK is the output of `lodeline batch`: a second call makes only what is missing, and makes all again with another build.
`--only clean all` measures the dive without further effects and with all of them.
"""

import argparse
import bisect
import csv
import json
import math
import subprocess
import sys
from pathlib import Path

from batch_runs import run_batch

ROOT = Path(__file__).resolve().parent.parent
SCENARIO, FIRST_SEED = "demo", 4001
# Variants of the batch by their number of cameras.
VARIANTS = {2: {"name": "stereo"}, 1: {"name": "left", "set": {"source.cameras": [0]}}}
COLUMNS = ["effect", "cameras", "heading drift, °/100 m", "scale error, %", "position rms, % of path",
           "position within 3 σ, %", "heading within 3 σ, %", "σ / error, position", "σ / error, heading"]
# Effects of a vehicle or a wreck of steel, which the scenario does not have.
ELSEWHERE = {"dvl_noise", "dvl_dropouts", "dvl_sentinels", "dvl_scale", "dvl_misalignment", "thruster_currents", "vibration",
             "steel"}
# Effects that act together with another one.
TOGETHER = {"port_in_files": ["flat_port=on"], "shutter_in_files": ["rolling_shutter=on"]}


def call(command):
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if result.returncode not in (0, 3):
        sys.exit(f"{' '.join(map(str, command))}: exit code {result.returncode}\n{result.stderr[-2000:]}")
    return result.stdout


def cases(program):
    """Name of each case and its options of `lodeline simulate`."""
    found = {"clean": []}
    for line in call([program, "simulate", "--list-effects"]).splitlines()[1:]:
        name, in_clean = line.split()[:2]
        if in_clean == "off" and name not in ELSEWHERE:
            found[name] = sum((["--effect", assignment] for assignment in [f"{name}=on", *TOGETHER.get(name, [])]), [])
    found["field"] = ["--realism", "field"]
    found["all"] = ["--realism", "physical"]
    found["all_dome"] = ["--realism", "physical", "--effect", "dome_port=on"]
    return found


def make_runs(found, seeds, arguments):
    """Simulates and runs all dives by `lodeline batch`. Returns the folder of each run by its name."""
    dive = [SCENARIO, "--seconds", arguments.seconds, "--width", arguments.width, "--camera-rate-hz", 10, "--imu",
            arguments.imu]
    listed = {"args": ["--no-report"], "variants": list(VARIANTS.values()), "seeds": list(seeds),
              "recordings": [{"name": name, "simulate": [*dive, *options]} for name, options in found.items()]}
    rows = run_batch(arguments.program, arguments.work, listed, arguments.jobs)
    # A run that ends with an error may have a trajectory.
    return {name: arguments.work / ("failed" if row["status"] == "failed" else "results") / name
            for name, row in rows.items()}


def evaluate(program, folder, out):
    """Figures of `lodeline evaluate`, aligned without and with scale; None where the run has no trajectory."""
    figures = []
    if not (out / "states.csv").exists():
        return None
    truth = folder / "mav0/state_groundtruth_estimate0/data.csv"
    for alignment in ("se3", "sim3"):
        file = out / f"{alignment}.json"
        file.unlink(missing_ok=True)
        call([program, "evaluate", out, truth, "--interpolate", "--align", alignment, "--json", file])
        if not file.exists():
            return None
        figures.append(json.loads(file.read_text()))
    return figures


def yaw(row, first):
    w, x, y, z = (float(row[i]) for i in range(first, first + 4))
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def wrapped(angle):
    return math.remainder(angle, 2 * math.pi)


def read(path):
    with path.open(encoding="utf-8") as file:
        rows = csv.reader(file)
        header = next(rows)
        return header, [row for row in rows if row]


class Errors:
    """Errors and claimed sigmas of the poses, with the first pose as the common origin of position and heading."""

    def __init__(self, out, folder):
        header, states = read(out / "states.csv")
        place = {name.split(" ")[0]: i for i, name in enumerate(header)}
        truth = read(folder / "mav0/state_groundtruth_estimate0/data.csv")[1]
        stamps = [int(row[0]) for row in truth]
        states = [row for row in states if row[place["p_x"]] not in ("", "nan")]
        self.position, self.heading, self.position_sigma, self.heading_sigma = [], [], [], []
        origin = None
        for row in states:
            match = truth[min(bisect.bisect_left(stamps, int(row[0])), len(truth) - 1)]
            here = [float(row[place[f"p_{axis}"]]) for axis in "xyz"]
            there = [float(match[i]) for i in (1, 2, 3)]
            turn = wrapped(yaw(row, place["q_w"]) - yaw(match, 4))
            if origin is None:
                origin = here, there, turn
            cosine, sine = math.cos(origin[2]), math.sin(origin[2])
            moved = [b - a for a, b in zip(origin[1], there)]
            expected = [cosine * moved[0] - sine * moved[1], sine * moved[0] + cosine * moved[1], moved[2]]
            self.position.append(math.dist([b - a for a, b in zip(origin[0], here)], expected))
            self.heading.append(wrapped(turn - origin[2]))
            self.position_sigma.append(math.hypot(*(float(row[place[f"sigma_p_{axis}"]]) for axis in "xyz")))
            self.heading_sigma.append(float(row[place["sigma_theta_z"]]))


def median(values):
    return sorted(values)[len(values) // 2]


def within(errors, sigmas):
    """Share of the errors within three sigmas, %."""
    held = [abs(error) <= 3 * sigma for error, sigma in zip(errors, sigmas)]
    return 100 * sum(held) / max(1, len(held))


def ratio(sigmas, errors):
    return median(sigmas) / max(1e-12, median([abs(error) for error in errors]))


def row(cells):
    return "| " + " | ".join(cells) + " |"


def root_mean_square(values):
    return math.sqrt(sum(value * value for value in values) / len(values))


class Dive:
    """Figures of one run of one dive."""

    def __init__(self, figures, errors):
        rigid, similar = figures
        path_m = rigid["reference"]["path_m"]
        tenth = max(1, len(errors.heading) // 10)
        drift_deg = math.degrees(sum(errors.heading[-tenth:]) / tenth)
        self.drift_deg_per_100_m = drift_deg / path_m * 100
        self.scale_error_percent = similar["alignment"]["scale_error_percent"]
        self.position_percent = 100 * rigid["absolute"]["position_m"]["rmse"] / path_m
        self.errors = errors


def measured(name, cameras, dives):
    def together(member):
        return sum((getattr(dive.errors, member)[1:] for dive in dives), [])

    def over_dives(member):
        return root_mean_square([getattr(dive, member) for dive in dives])

    position, position_sigma = together("position"), together("position_sigma")
    heading, heading_sigma = together("heading"), together("heading_sigma")
    return row([name, str(cameras), f"{over_dives('drift_deg_per_100_m'):.2f}", f"{over_dives('scale_error_percent'):.2f}",
                f"{over_dives('position_percent'):.2f}", f"{within(position, position_sigma):.1f}",
                f"{within(heading, heading_sigma):.1f}", f"{ratio(position_sigma, position):.2f}",
                f"{ratio(heading_sigma, heading):.2f}"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("work", type=Path)
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/bin/lodeline")
    parser.add_argument("--only", nargs="*", help="effects to measure; also clean, field, all")
    parser.add_argument("--seeds", type=int, default=1, help="number of dives for each effect")
    parser.add_argument("--seconds", type=float, default=45)
    parser.add_argument("--width", type=int, default=480)
    parser.add_argument("--imu", default="gx5-25")
    parser.add_argument("--jobs", type=int, default=1, help="number of runs at a time")
    parser.add_argument("--markdown", type=Path, help="file for the table")
    arguments = parser.parse_args()
    found = cases(arguments.program)
    unknown = set(arguments.only or []) - set(found)
    if unknown:
        sys.exit(f"no such effect: {', '.join(sorted(unknown))}; there are {', '.join(found)}")
    found = {name: options for name, options in found.items() if not arguments.only or name in arguments.only}
    seeds = range(FIRST_SEED, FIRST_SEED + arguments.seeds)
    runs = make_runs(found, seeds, arguments)
    lines = [row(COLUMNS), row(["---"] * len(COLUMNS))]
    print("\n".join(lines), flush=True)
    for name in found:
        dives = {cameras: [] for cameras in VARIANTS}
        for seed in seeds:
            folder = arguments.work / "recordings" / f"{name}.{seed}"
            for cameras, variant in VARIANTS.items():
                out = runs[f"{name}.{variant['name']}.{seed}"]
                figures = evaluate(arguments.program, folder, out)
                if figures:
                    dives[cameras].append(Dive(figures, Errors(out, folder)))
        for cameras, measurements in dives.items():
            if len(measurements) < arguments.seeds:
                print(f"{name}, {cameras} cameras: {arguments.seeds - len(measurements)} runs without a result")
            lines.append(measured(name, cameras, measurements) if measurements else
                         row([name, str(cameras), *["–"] * (len(COLUMNS) - 2)]))
            print(lines[-1], flush=True)
            if arguments.markdown:
                arguments.markdown.parent.mkdir(parents=True, exist_ok=True)
                arguments.markdown.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
