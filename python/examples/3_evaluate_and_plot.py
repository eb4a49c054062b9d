"""Compares a run with the ground truth of its recording, in figures and plots: 3_evaluate_and_plot.py DATA PLOTS [SECONDS]"""

import sys
from pathlib import Path

import lodeline
import matplotlib.pyplot as plt
import numpy as np


def draw_paths(evaluation, landmarks):
    figure, axes = plt.subplots(figsize=(7, 5), layout="constrained")
    truth, estimate = (poses[:, :2, 3] for poses in (evaluation.reference_poses, evaluation.aligned_poses))
    axes.scatter(*landmarks[:, :2].T, s=1, color="0.8", label="landmarks")
    axes.plot(*truth.T, color="k", linewidth=2.5, label="ground truth")
    axes.plot(*estimate.T, color="C1", linewidth=1.5, label="estimate")
    middle, reach = truth.mean(axis=0), np.ptp(truth, axis=0).max() + 2
    axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", title="Path from above")
    axes.set(xlim=middle[0] + reach * np.array([-1, 1]), ylim=middle[1] + reach * np.array([-1, 1]))
    axes.legend()
    return figure


def draw_errors(evaluation, estimates, truth_from_world):
    """Errors and sigmas in the axes of the estimate's world; both are relative to the first pose."""
    figure, rows = plt.subplots(3, 1, sharex=True, figsize=(7, 6), layout="constrained")
    seconds = (estimates.times_ns - estimates.times_ns[0]) * 1e-9
    sigmas = np.sqrt(estimates.pose_covariances[:, range(3), range(3)])
    errors = evaluation.position_errors_m @ truth_from_world[:3, :3]
    pairs = (evaluation.times_ns - estimates.times_ns[0]) * 1e-9
    for axis, axes in enumerate(rows):
        axes.fill_between(seconds, -3 * sigmas[:, axis], 3 * sigmas[:, axis], color="C0", alpha=0.25, label="3 sigma")
        axes.plot(pairs, errors[:, axis], color="C1", label="error")
        axes.set_ylabel(f"{'xyz'[axis]} [m]")
        axes.grid(alpha=0.3)
    rows[0].legend(loc="upper left")
    rows[0].set_title("Position errors")
    rows[-1].set_xlabel("time [s]")
    return figure


def main(data, plots, seconds=None):
    settings = {} if seconds is None else {"source.duration_s": float(seconds)}
    run = lodeline.run(data, settings=settings)
    truth = Path(data) / "mav0/state_groundtruth_estimate0"
    estimates = run.estimates
    print(lodeline.evaluate(estimates.trajectory, truth, align="yaw"))

    # From equal first poses.
    evaluation = lodeline.evaluate(estimates.trajectory, truth, align="yaw", align_pairs=1)
    first = np.searchsorted(estimates.times_ns, evaluation.times_ns[0])
    truth_from_world = evaluation.aligned_poses[0] @ np.linalg.inv(estimates.poses[first])
    landmarks = estimates.landmarks @ truth_from_world[:3, :3].T + truth_from_world[:3, 3]
    Path(plots).mkdir(exist_ok=True)
    draw_paths(evaluation, landmarks).savefig(Path(plots) / "path.png", dpi=110)
    draw_errors(evaluation, estimates, truth_from_world).savefig(Path(plots) / "errors.png", dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:])
