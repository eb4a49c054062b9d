import os
import signal
import threading
import time
import unittest

import lodeline
import numpy as np
from support import SAMPLE, SECONDS, FolderTest


class RunTest(FolderTest):
    def test_files_are_those_of_the_program(self):
        self.program("run", SAMPLE, "-o", "theirs", "--no-report", "-q", "--set", "source.duration_s=5")
        lodeline.run(SAMPLE, self.folder / "ours", settings=SECONDS)
        for name in ("trajectory.tum", "states.csv", "landmarks.ply"):
            ours, theirs = (self.folder / run / name for run in ("ours", "theirs"))
            self.assertEqual(ours.read_bytes(), theirs.read_bytes(), name)

    def test_arrays_are_those_of_the_files(self):
        result = lodeline.run(SAMPLE, self.folder / "run", settings=SECONDS)
        estimates = result.estimates
        count = len(estimates)
        self.assertGreater(count, 20)
        table = np.loadtxt(self.folder / "run/trajectory.tum")
        self.assertEqual(table.shape, (count, 8))
        np.testing.assert_allclose(estimates.positions, table[:, 1:4], atol=1e-9)
        np.testing.assert_allclose(estimates.quaternions, table[:, [7, 4, 5, 6]], atol=1e-9)
        states = lodeline.read_run(self.folder / "run").states()
        posed = np.isfinite(states["p_x [m]"])
        np.testing.assert_array_equal(estimates.times_ns, states["times_ns"][posed])
        self.assertEqual(estimates.times_ns.dtype, np.int64)
        np.testing.assert_allclose(estimates.velocities[:, 1], states["v_y [m/s]"][posed], rtol=1e-7, atol=1e-9)
        np.testing.assert_allclose(estimates.pose_covariances[:, 0, 4], states["cov_pose_04"][posed], rtol=1e-7, atol=1e-15)
        np.testing.assert_allclose(estimates.gyroscope_biases[:, 2], states["b_g_z [rad/s]"][posed], rtol=1e-7, atol=1e-12)
        np.testing.assert_allclose(estimates.heading_sigmas, states["sigma_heading [rad]"][posed], rtol=1e-7)
        np.testing.assert_allclose(estimates.depths_m, states["depth [m]"][posed], rtol=1e-7)
        np.testing.assert_array_equal(estimates.landmark_counts, states["landmarks"][posed])
        self.assertEqual(list(estimates.statuses), [s for s, p in zip(states["status"], posed) if p])
        written = lodeline.read_run(self.folder / "run")
        np.testing.assert_allclose(estimates.landmarks, written.landmarks, atol=1e-5)
        np.testing.assert_array_equal(estimates.landmark_observations, written.landmark_observations)

    def test_shapes(self):
        estimates = lodeline.run(SAMPLE, settings=SECONDS).estimates
        count = len(estimates)
        self.assertEqual(estimates.poses.shape, (count, 4, 4))
        self.assertEqual(estimates.pose_covariances.shape, (count, 6, 6))
        np.testing.assert_allclose(estimates.poses[:, :3, 3], estimates.positions)
        rotations = estimates.poses[:, :3, :3]
        np.testing.assert_allclose(rotations @ rotations.transpose(0, 2, 1), np.broadcast_to(np.eye(3), (count, 3, 3)), atol=1e-9)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_progress_sees_every_frame(self):
        seen = []
        result = lodeline.run(SAMPLE, settings=SECONDS, progress=lambda estimate: seen.append(estimate))
        self.assertEqual(len(seen), result.summary["frames"])
        posed = [e for e in seen if e.has_pose]
        self.assertEqual(len(posed), len(result.estimates))
        self.assertEqual(posed[-1].covariance.shape, (15, 15))
        np.testing.assert_array_equal(posed[-1].position, result.estimates.positions[-1])
        self.assertFalse(result.was_stopped)

    def test_progress_stops_the_run(self):
        count = 0

        def progress(_):
            nonlocal count
            count += 1
            return np.bool_(count < 15)

        result = lodeline.run(SAMPLE, self.folder / "run", progress=progress)
        self.assertEqual(count, 15)
        self.assertTrue(result.was_stopped)
        self.assertTrue((self.folder / "run/run.json").exists())

    def test_an_exception_of_progress_comes_out(self):
        def progress(_):
            raise LookupError("mine")

        with self.assertRaisesRegex(LookupError, "mine"):
            lodeline.run(SAMPLE, self.folder / "run", progress=progress)
        self.assertTrue((self.folder / "run/run.json").exists())

    def test_ctrl_c_stops_the_run(self):
        threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT)).start()
        with self.assertRaises(KeyboardInterrupt):
            while True:
                lodeline.run(SAMPLE, settings=SECONDS)

    def test_other_threads_go_on(self):
        ticks, done = [], threading.Event()

        def tick():
            while not done.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.005)

        thread = threading.Thread(target=tick)
        thread.start()
        start = time.monotonic()
        lodeline.run(SAMPLE, settings=SECONDS)
        took = time.monotonic() - start
        done.set()
        thread.join()
        # Whoever keeps Python's lock for the whole run leaves one tick.
        self.assertGreater(len(ticks), 10)
        self.assertLess(max(np.diff(ticks)), max(0.5, 0.5 * took))

    def test_settings(self):
        one = lodeline.run(SAMPLE, self.folder / "one", settings={**SECONDS, "source.cameras": [0], "loops.enabled": False})
        text = (self.folder / "one/config.yaml").read_text()
        self.assertIn("cameras: [0]", text)
        self.assertGreater(len(one.estimates), 0)

    def test_a_start_in_a_map(self):
        magnetometer = SAMPLE / "magnetometer.yaml"
        earlier, start, sigma = self.folder / "earlier", (1.5, 0.5, -0.5), (2.0, 0.5)
        lodeline.run(SAMPLE, earlier, settings=SECONDS, magnetometer_calibration=magnetometer)
        # The rig looks the other way by then, and recognizes nothing.
        part = {"source.skip_s": 14, "source.duration_s": 2}
        options = {"magnetometer_calibration": magnetometer, "map": earlier / "map.db", "settings": part, "check": False}
        lodeline.run(SAMPLE, self.folder / "ours", start=start, start_sigma=sigma, **options)
        self.program("run", SAMPLE, "-o", "theirs", "--no-report", "-q", "--from", 14, "--to", 16, "--mag-calibration", magnetometer,
                     "--map", earlier / "map.db", "--start", "1.5,0.5,-0.5", "--start-sigma", "2,0.5")
        ours, theirs = (self.folder / run / "trajectory_map.tum" for run in ("ours", "theirs"))
        self.assertEqual(ours.read_bytes(), theirs.read_bytes())
        np.testing.assert_allclose(np.loadtxt(ours)[0, 1:4], start, atol=0.1)
        for wrong in ({"start_sigma": sigma}, {"start": start, "map": None}, {"start": (1.0, 2.0, float("nan"))},
                      {"start": start, "start_sigma": (0.0, 1.0)}):
            with self.assertRaises(lodeline.UsageError):
                lodeline.run(SAMPLE, self.folder / "wrong", **{**options, **wrong})


class ErrorTest(FolderTest):
    def test_missing_recording(self):
        missing = self.folder / "none"
        printed = self.program("run", missing, "-o", "out", exit_code=1)
        with self.assertRaises(lodeline.InputError) as caught:
            lodeline.run(missing, self.folder / "out")
        self.assertEqual(printed, f"bad input: {caught.exception}\n")

    def test_unknown_setting(self):
        with self.assertRaisesRegex(lodeline.UsageError, "source.duraton_s"):
            lodeline.run(SAMPLE, settings={"source.duraton_s": 3})

    def test_a_result_that_is_not_to_be_trusted(self):
        out, three_seconds = self.folder / "out", {"source.duration_s": 3}
        printed = self.program("run", SAMPLE, "-o", out, "-q", "--no-report", "--set", "source.duration_s=3", exit_code=3)
        with self.assertRaises(lodeline.EstimationError) as caught:
            lodeline.run(SAMPLE, out, settings=three_seconds, overwrite=True)
        self.assertEqual(printed, f"estimation failed: {caught.exception}\n")
        with self.assertRaisesRegex(lodeline.EstimationError, "the result is not to be trusted"):
            lodeline.run(SAMPLE, settings=three_seconds)
        self.assertGreater(len(lodeline.run(SAMPLE, settings=three_seconds, check=False).estimates), 0)

    def test_another_run_is_kept(self):
        lodeline.run(SAMPLE, self.folder / "run", settings=SECONDS)
        with self.assertRaises(lodeline.UsageError):
            lodeline.run(SAMPLE, self.folder / "run", settings=SECONDS)
        lodeline.run(SAMPLE, self.folder / "run", settings=SECONDS, overwrite=True)

    def test_files_need_a_folder(self):
        for option in ({"report": True}, {"refine_interval_s": 0.5}, {"map": "map.db"}):
            with self.assertRaises(lodeline.UsageError):
                lodeline.run(SAMPLE, **option)

    def test_every_error_is_an_error(self):
        for kind in (lodeline.InputError, lodeline.UsageError, lodeline.EstimationError):
            self.assertTrue(issubclass(kind, lodeline.Error))


if __name__ == "__main__":
    unittest.main()
