"""Draws the Allan deviation of a gyroscope whose noise is known: 4_sensor_noise.py PLOTS"""

import sys
import warnings
from pathlib import Path

import lodeline
import matplotlib.pyplot as plt
import numpy as np

RATE_HZ = 100
WHITE, WALK = 2e-4, 5e-5  # rad/s/sqrt(Hz), rad/s^2/sqrt(Hz)


def readings(seconds):
    """White noise on a random walk."""
    random = np.random.default_rng(7)
    count = int(seconds * RATE_HZ)
    walk = np.cumsum(random.normal(0, WALK / np.sqrt(RATE_HZ), (count, 3)), axis=0)
    times_ns = np.arange(count) * (1_000_000_000 // RATE_HZ)
    return times_ns, walk + random.normal(0, WHITE * np.sqrt(RATE_HZ), (count, 3))


def main(plots):
    warnings.simplefilter("ignore", lodeline.FindingWarning)  # says that the record is short
    noise = lodeline.allan_of("gyroscope", *readings(seconds=1800))
    print(f"white noise {noise.white_noise:.3g} (true: {WHITE:.3g}) {noise.unit}/sqrt(Hz)")
    print(f"random walk {noise.random_walk:.3g} (true: {WALK:.3g}) {noise.unit}/s/sqrt(Hz)")

    figure, axes = plt.subplots(figsize=(7, 4.5), layout="constrained")
    for axis, name in enumerate("xyz"):
        axes.loglog(noise.taus_s, noise.deviations[:, axis], label=name)
    taus = noise.taus_s
    axes.loglog(taus, np.sqrt(WHITE**2 / taus + WALK**2 * taus / 3), "k--", label="true noise")
    axes.set(xlabel="averaging time [s]", ylabel="Allan deviation [rad/s]", title="Gyroscope at rest")
    axes.grid(which="both", alpha=0.3)
    axes.legend()
    Path(plots).mkdir(exist_ok=True)
    figure.savefig(Path(plots) / "allan.png", dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:])
