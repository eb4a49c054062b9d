#!/usr/bin/env python3
"""Measures how many short clips of a dive are found in the map of another day, and how far off their poses are.

Runs `lodeline run` on simulated dives of one cave, builds a map of the first and looks for clips of the others in it. A
clip is a revisit if a keyframe of the map is within 1 m and 20° of its last pose. The error is that of the pose relative to
the nearest keyframe, so that errors of the map elsewhere do not count.

    relocalisation.py WORK OLD NEW [NEW ...] [--program build/release/bin/lodeline] [--clip SECONDS]

OLD and NEW are recordings of `lodeline simulate` with one --cave-seed. WORK gets the results; existing runs are used again.
"""

import argparse
import bisect
import csv
import math
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NEAR_M, NEAR_DEG, WRONG_M = 1.0, 20.0, 0.3


def product(a, b):
    w, x, y, z = a
    W, X, Y, Z = b
    return (w * W - x * X - y * Y - z * Z, w * X + x * W + y * Z - z * Y, w * Y - x * Z + y * W + z * X,
            w * Z + x * Y - y * X + z * W)


def inverse(q):
    return (q[0], -q[1], -q[2], -q[3])


def rotated(q, v):
    return product(product(q, (0.0, *v)), inverse(q))[1:]


def angle_deg(a, b):
    d = product(inverse(a), b)
    return math.degrees(2.0 * math.atan2(math.hypot(*d[1:]), abs(d[0])))


def difference(a, b):
    return [x - y for x, y in zip(a, b)]


class Truth:
    """True poses of the body in the frame of the cave, which dives with one cave seed share."""

    def __init__(self, recording):
        text = (recording / "truth/cave.yaml").read_text()
        origin_m = [float(x) for x in re.search(r"world_from_cave_m: \[(.*)\]", text).group(1).split(",")]
        self.times_ns, self.poses = [], []
        with open(recording / "mav0/state_groundtruth_estimate0/data.csv") as file:
            for row in csv.reader(line for line in file if not line.startswith("#")):
                self.times_ns.append(int(row[0]))
                self.poses.append((difference(map(float, row[1:4]), origin_m), tuple(map(float, row[4:8]))))

    def at(self, time_ns):
        """Position (m) and rotation, linear between the two nearest times."""
        i = min(max(bisect.bisect_left(self.times_ns, time_ns), 1), len(self.times_ns) - 1)
        (p, q), (P, Q) = self.poses[i - 1], self.poses[i]
        share = (time_ns - self.times_ns[i - 1]) / (self.times_ns[i] - self.times_ns[i - 1])
        share = min(max(share, 0.0), 1.0)
        sign = 1.0 if sum(x * y for x, y in zip(q, Q)) > 0.0 else -1.0
        mixed = [(1.0 - share) * x + share * sign * y for x, y in zip(q, Q)]
        return ([(1.0 - share) * x + share * y for x, y in zip(p, P)],
                tuple(x / math.hypot(*mixed) for x in mixed))


def keyframes_of(trajectory):
    """Time (ns), position (m) and rotation of each line of a TUM file."""
    rows = []
    for line in trajectory.read_text().splitlines():
        if line.startswith("#"):
            continue
        seconds, x, y, z, qx, qy, qz, qw = line.split()
        whole, _, part = seconds.partition(".")
        rows.append((int(whole) * 10**9 + int((part + 9 * "0")[:9]), [float(x), float(y), float(z)],
                     (float(qw), float(qx), float(qy), float(qz))))
    return rows


def examine(keyframes, old, new, clips):
    """Counts of clips, and the errors (m) of those that were found."""
    true_keyframes = [old.at(time_ns) for time_ns, _, _ in keyframes]
    revisits = found_revisits = 0
    errors_m = []
    with open(clips) as file:
        for row in csv.reader(line for line in file if not line.startswith("#")):
            position, rotation = new.at(int(row[0]))
            is_revisit = any(math.dist(p, position) <= NEAR_M and angle_deg(q, rotation) <= NEAR_DEG
                             for p, q in true_keyframes)
            is_found = row[1] == "1"
            revisits += is_revisit
            found_revisits += is_revisit and is_found
            if not is_found:
                continue
            i = min(range(len(keyframes)), key=lambda k: math.dist(true_keyframes[k][0], position))
            true_p, true_q = true_keyframes[i]
            _, p, q = keyframes[i]
            errors_m.append(math.dist(rotated(inverse(true_q), difference(position, true_p)),
                                      rotated(inverse(q), difference(map(float, row[2:5]), p))))
    return revisits, found_revisits, errors_m


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("work", type=Path)
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path, nargs="+")
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/bin/lodeline")
    parser.add_argument("--clip", default="3")
    arguments = parser.parse_args()

    def call(*words):
        subprocess.run([str(arguments.program), *map(str, words), "--quiet"], check=True)

    def run(recording):
        result = arguments.work / recording.name
        if not (result / "run.json").exists():
            call("run", recording, "-o", result, "--no-report")
        return result

    arguments.work.mkdir(parents=True, exist_ok=True)
    cave, poses = arguments.work / "cave.db", arguments.work / "poses"
    call("map", "build", cave, run(arguments.old), "--overwrite")
    call("map", "export", cave, "--format", "tum", "-o", poses, "--overwrite")
    keyframes, old = keyframes_of(next(poses.glob("*.tum"))), Truth(arguments.old)
    print("dive,revisits,found,found elsewhere,wrong,median error [m],rms error [m],greatest error [m]")
    for recording in arguments.new:
        clips = arguments.work / f"{recording.name}_clips.csv"
        call("map", "relocalise", cave, run(recording), "--clip", arguments.clip, "-o", clips)
        revisits, found, errors_m = examine(keyframes, old, Truth(recording), clips)
        errors_m.sort()
        rms_m = math.sqrt(sum(e * e for e in errors_m) / len(errors_m)) if errors_m else math.nan
        print(f"{recording.name},{revisits},{found},{len(errors_m) - found},{sum(e > WRONG_M for e in errors_m)},"
              + ",".join(f"{e:.3f}" for e in (errors_m[len(errors_m) // 2], rms_m, errors_m[-1]) if errors_m))


if __name__ == "__main__":
    sys.exit(main())
