"""Compares a run with the truth and with its stated uncertainty; names every breach of contract.

  crash, hang   ended by a signal or with an undocumented exit code, or did not end
  nan           a pose or a sigma is not a number
  lost          fewer poses than images before the fault
  untold        the fault does harm, the exit code is 0, and no finding is above a notice
  SILENT        more than 5 % of the poses are wrong by over 5 sigma and 0.10 m, and the run reported nothing
  wrong_told    the same errors, but the run reported a finding
"""
import bisect
import json
import math

TRUTH_SIGMA_M = 0.005  # one sigma of truth and alignment together
POSES_TO_ALIGN = 15


def read_truth(path):
    """Sorted positions (t in s, x, y, z) of a TUM file or of EuRoC's state_groundtruth_estimate0/data.csv"""
    poses = []
    for line in path.read_text().splitlines():
        if line and line[0] != "#":
            fields = [float(f) for f in line.replace(",", " ").split()[:4]]
            poses.append((fields[0] * (1e-9 if path.suffix == ".csv" else 1.0), *fields[1:4]))
    return sorted(poses)


def read_poses(path):
    """Poses of trajectory.tum; a line that is not a pose becomes None."""
    poses = []
    for line in path.read_text(errors="replace").splitlines() if path.exists() else []:
        if line.startswith("#"):
            continue
        try:
            fields = [float(f) for f in line.split()]
        except ValueError:
            fields = []
        poses.append(fields if len(fields) == 8 and all(map(math.isfinite, fields)) else None)
    return poses


def read_sigmas(path):
    """Map from stamp in ns to one sigma of the position in m, from states.csv; None where a frame with a pose has none."""
    lines = path.read_text(errors="replace").splitlines() if path.exists() else []
    if not lines:
        return {}
    columns = [i for i, name in enumerate(lines[0].split(",")) if name.startswith("sigma_p_")]
    sigmas = {}
    for line in lines[1:]:
        fields = line.split(",")
        if len(fields) < max(columns) or fields[1] in ("waiting", "attitude"):
            continue
        values = [float(fields[i]) for i in columns]
        if not all(math.isfinite(v) and v > 0.0 for v in values):
            return None
        sigmas[int(fields[0])] = math.hypot(*values)
    return sigmas


def position_at(truth, t):
    i = bisect.bisect(truth, (t,))
    if i == 0 or i == len(truth):
        return None
    before, after = truth[i - 1], truth[i]
    w = (t - before[0]) / (after[0] - before[0])
    return [before[k] + w * (after[k] - before[k]) for k in (1, 2, 3)]


def aligned_errors(estimate, truth, align_count):
    """Position errors (index, error in m) after alignment of the first poses by yaw and translation."""
    pairs = [(i, pose[1:4], position_at(truth, pose[0])) for i, pose in enumerate(estimate)]
    pairs = [pair for pair in pairs if pair[2]]
    if len(pairs) < 5:
        return []
    fit = pairs[:align_count] if align_count >= POSES_TO_ALIGN else pairs
    mean = [[sum(pair[which][k] for pair in fit) / len(fit) for k in range(3)] for which in (1, 2)]
    centred = [([e[k] - mean[0][k] for k in range(3)], [g[k] - mean[1][k] for k in range(3)]) for _, e, g in fit]
    yaw = math.atan2(sum(e[0] * g[1] - e[1] * g[0] for e, g in centred), sum(e[0] * g[0] + e[1] * g[1] for e, g in centred))
    c, s = math.cos(yaw), math.sin(yaw)
    errors = []
    for i, e, g in pairs:
        x, y, z = (e[k] - mean[0][k] for k in range(3))
        moved = (c * x - s * y + mean[1][0], s * x + c * y + mean[1][1], z + mean[1][2])
        errors.append((i, math.dist(moved, g)))
    return errors


def on_clock_of_truth(t, info):
    t -= info.get("offset_ns", 0) * 1e-9
    last_ns, offset_s = info.get("jump", (2**63, 0.0))
    return t - offset_s if t > last_ns * 1e-9 + 1e-3 else t


def judge(fault, info, output, exit_code, text, truth):
    breaches, row = [], {"exit_code": exit_code, "what": info.get("what", "")}
    if exit_code is None:
        breaches.append("hang")
    elif exit_code not in (0, 1, 2, 3, 130) or "unexpected failure" in text or "terminate called" in text:
        breaches.append("crash")
    poses, sigmas = read_poses(output / "trajectory.tum"), read_sigmas(output / "states.csv")
    if None in poses or sigmas is None:
        breaches.append("nan")
    poses, sigmas = [pose for pose in poses if pose], sigmas or {}
    findings = []
    if (output / "run.json").exists():
        findings = json.loads((output / "run.json").read_text()).get("findings", [])
    row["findings"] = sorted({f["kind"] for f in findings if f["severity"] != "notice"})
    is_told = bool(row["findings"]) or exit_code != 0
    until = 0 if info.get("fatal") else info.get("until", 0)
    if len(poses) < until:
        breaches.append("lost")
    if fault.does_harm and not fault.is_calibration and not is_told:
        breaches.append("untold")
    moved = [[on_clock_of_truth(pose[0], info)] + pose[1:] for pose in poses]
    errors = aligned_errors(moved, truth, until)
    if errors:
        stamps = sorted(sigmas)
        wrong = 0
        for i, error in errors:
            at = min(bisect.bisect(stamps, int(poses[i][0] * 1e9) - 1000), len(stamps) - 1)
            sigma = sigmas[stamps[at]] if stamps else 0.0
            wrong += error > 0.10 and error > 5.0 * math.hypot(sigma, TRUTH_SIGMA_M)
        row["rmse_m"] = math.sqrt(sum(e * e for _, e in errors) / len(errors))
        row["wrong_share"] = wrong / len(errors)
        if row["wrong_share"] > 0.05:
            breaches.append("wrong_told" if is_told else "SILENT")
    row.update(poses=len(poses), breaches=breaches)
    return row
