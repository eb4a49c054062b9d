"""Simulates a rig that is turned about, calibrates its magnetometer and draws it: 5_calibrate_magnetometer.py PLOTS"""

import sys
import warnings
from pathlib import Path

import lodeline
import matplotlib.pyplot as plt
import numpy as np


def main(plots):
    plots = Path(plots)
    plots.mkdir(exist_ok=True)
    lodeline.simulate("figure_eight", plots / "recording", seconds=60, no_images=True)
    calibration = lodeline.calibrate_magnetometer(plots / "recording")
    print(calibration)
    calibration.write(plots / "magnetometer.yaml")  # for lodeline.run(magnetometer_calibration=...)

    warnings.simplefilter("ignore", lodeline.FindingWarning)
    times_ns, fields = lodeline.Recording(plots / "recording").magnetometer()
    seconds = (times_ns - times_ns[0]) * 1e-9
    figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
    axes.plot(seconds, 1e6 * np.linalg.norm(fields, axis=1), color="0.6", label="as measured")
    axes.plot(seconds, 1e6 * np.linalg.norm(calibration.corrected(fields), axis=1), color="C1", label="corrected")
    axes.axhline(1e6 * calibration.field_strength_T, color="k", linewidth=0.8, linestyle="--", label="field strength")
    axes.set(xlabel="time [s]", ylabel="size of the field [uT]", title="Magnetometer of a turned rig")
    axes.legend()
    figure.savefig(plots / "magnetometer.png", dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:])
