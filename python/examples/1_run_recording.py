"""Estimates a trajectory from a recording and says how well it is known: 1_run_recording.py DATA OUT [SECONDS]"""

import sys

import lodeline
import numpy as np


def main(data, output, seconds=None):
    settings = {} if seconds is None else {"source.duration_s": float(seconds)}

    def progress(estimate):
        print(f"\r{estimate.time_ns * 1e-9:.1f} s: {estimate.status}, {estimate.landmarks} landmarks  ", end="", file=sys.stderr)

    run = lodeline.run(data, output, settings=settings, progress=progress)
    print(file=sys.stderr)

    estimates = run.estimates
    sigmas = np.sqrt(estimates.pose_covariances[:, range(6), range(6)])  # (N, 6): m, rad
    length = np.linalg.norm(np.diff(estimates.positions, axis=0), axis=1).sum()
    print(f"{len(estimates)} poses over {length:.2f} m, {len(estimates.landmarks)} landmarks")
    print(f"the last position is known to {sigmas[-1, :3]} m, the heading to {np.degrees(estimates.heading_sigmas[-1]):.2f} deg")
    for finding in run.findings:
        print(f"{finding.severity}: {finding.message} ({finding.count} times)")


if __name__ == "__main__":
    main(*sys.argv[1:])
