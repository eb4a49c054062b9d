import json
import unittest
import warnings

import lodeline
import numpy as np
from support import FolderTest

RATE = 100
NANOSECONDS = 1_000_000_000 // RATE


def white(sigma, count, seed):
    return np.random.default_rng(seed).normal(0, sigma, (count, 3))


def directions(count=3000):
    """Slow turns through all directions."""
    t = np.arange(count) / RATE
    azimuth, elevation = 1.7 * t, 1.4 * np.sin(0.41 * t)
    return np.stack([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)], axis=1)


class NoiseTest(FolderTest):
    def setUp(self):
        super().setUp()
        warnings.simplefilter("ignore", lodeline.FindingWarning)  # records are short
        self.addCleanup(warnings.resetwarnings)

    def test_white_noise(self):
        sigma = 2e-3
        times = np.arange(60_000) * NANOSECONDS
        noise = lodeline.allan_of("gyroscope", times, white(sigma, len(times), 1) + [0.01, 0, -0.02])
        self.assertAlmostEqual(noise.white_noise / (sigma / np.sqrt(RATE)), 1, delta=0.05)
        self.assertAlmostEqual(noise.rate_hz, RATE, delta=1e-6)
        expected = sigma / np.sqrt(RATE) / np.sqrt(noise.taus_s)
        first = noise.taus_s < 1
        np.testing.assert_allclose(noise.deviations[first], np.repeat(expected[first, None], 3, axis=1), rtol=0.1)
        self.assertEqual((noise.name, noise.unit), ("gyroscope", "rad/s"))

    def test_a_table(self):
        count = 30_000
        time = np.arange(count) / RATE
        rows = np.column_stack([time, white(1e-3, count, 2), white(1e-2, count, 3) + [0, 0, 9.81]])
        np.savetxt(self.folder / "rest.csv", rows, delimiter=",", fmt="%.9f", comments="",
                   header="t [s],wx [rad/s],wy [rad/s],wz [rad/s],ax [m/s^2],ay [m/s^2],az [m/s^2]")
        sensors = lodeline.allan(self.folder / "rest.csv")
        self.assertEqual(list(sensors), ["gyroscope", "accelerometer"])
        self.program("allan", "rest.csv", "--json", "theirs.json")
        theirs = json.loads((self.folder / "theirs.json").read_text())
        self.assertEqual(sensors["accelerometer"].figures, theirs["sensors"]["accelerometer"])
        readings = lodeline.read_readings(self.folder / "rest.csv")
        np.testing.assert_allclose(readings["specific_force"], rows[:, 4:], atol=1e-9)
        np.testing.assert_allclose(readings["times_ns"] * 1e-9, time, atol=1e-8)
        self.assertIsNone(readings["field_T"])

    def test_refusals(self):
        times = np.arange(10) * NANOSECONDS
        with self.assertRaises(lodeline.InputError):
            lodeline.allan_of("gyroscope", times, white(1e-3, 10, 1))
        with self.assertRaisesRegex(lodeline.UsageError, "thermometer"):
            lodeline.allan_of("thermometer", times, white(1e-3, 10, 1))
        with self.assertRaises(ValueError):
            lodeline.allan_of("gyroscope", times, np.zeros((10, 2)))
        with self.assertRaises(lodeline.InputError):
            lodeline.allan(self.folder / "none.csv")


class MagnetometerTest(FolderTest):
    soft = np.array([[1.1, 0.05, -0.02], [0.05, 0.95, 0.03], [-0.02, 0.03, 1.0]])
    hard = np.array([12e-6, -30e-6, 5e-6])

    def readings(self, strength=48e-6):
        fields = strength * directions()
        readings = np.linalg.solve(self.soft, fields.T).T + self.hard + white(5e-8, len(fields), 4)
        return np.arange(len(fields)) * NANOSECONDS, readings

    def test_iron(self):
        times, readings = self.readings()
        result = lodeline.calibrate_magnetometer_readings(times, readings)
        np.testing.assert_allclose(result.hard_iron, self.hard, atol=2e-7)
        scale = np.cbrt(np.linalg.det(self.soft) / np.linalg.det(result.iron_correction))
        np.testing.assert_allclose(scale * result.iron_correction, self.soft, atol=0.01)
        norms = np.linalg.norm(result.corrected(readings), axis=1)
        self.assertLess(norms.std() / norms.mean(), 0.005)
        self.assertEqual(result.covariance.shape, (12, 12))
        self.assertIsNone(result.body_from_magnetometer)

    def test_the_site_gives_the_strength(self):
        times, readings = self.readings()
        result = lodeline.calibrate_magnetometer_readings(times, readings, site=(29.83, -82.6, 20), date="2026-11-21")
        self.assertGreater(result.field_strength_T, 40e-6)
        norms = np.linalg.norm(result.corrected(readings), axis=1)
        self.assertAlmostEqual(norms.mean() / result.field_strength_T, 1, delta=1e-3)
        with self.assertRaises(lodeline.UsageError):
            lodeline.calibrate_magnetometer_readings(times, readings, site=(29.83, -82.6, 20))

    def test_files(self):
        times, readings = self.readings()
        np.savetxt(self.folder / "cloud.csv", np.column_stack([times * 1e-9, 1e6 * readings]), delimiter=",", fmt="%.6f",
                   comments="", header="t [s],mx [uT],my [uT],mz [uT]")
        lodeline.calibrate_magnetometer(self.folder / "cloud.csv").write(self.folder / "ours.yaml")
        self.program("calibrate", "magnetometer", "cloud.csv", "-o", "theirs.yaml")
        self.assertEqual((self.folder / "ours.yaml").read_bytes(), (self.folder / "theirs.yaml").read_bytes())

    def test_one_direction_is_too_little(self):
        times = np.arange(1000) * NANOSECONDS
        with self.assertRaises(lodeline.EstimationError):
            lodeline.calibrate_magnetometer_readings(times, np.full((1000, 3), 3e-5) + white(5e-8, 1000, 1))


if __name__ == "__main__":
    unittest.main()
