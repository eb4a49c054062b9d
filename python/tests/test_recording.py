import unittest
import warnings

import lodeline
import numpy as np
from support import SAMPLE, FolderTest


COLUMNS = {"imu0": 7, "mag0": 4, "pressure0": 2, "sonar0": 3}


def table(sensor):
    file = SAMPLE / f"mav0/{sensor}/data.csv"
    return np.loadtxt(file, delimiter=",", usecols=range(1, COLUMNS[sensor]), ndmin=2)


class RecordingTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.recording = lodeline.Recording(SAMPLE)

    def test_readings_are_those_of_the_files(self):
        times, rates, forces = self.recording.imu(corrected=False)
        np.testing.assert_array_equal(np.hstack([rates, forces]), table("imu0"))
        self.assertEqual(times.dtype, np.int64)
        self.assertEqual(times[0], 1795255200000000000)
        np.testing.assert_array_equal(self.recording.magnetometer()[1], table("mag0"))
        np.testing.assert_array_equal(self.recording.depth()[1], table("pressure0")[:, 0])
        self.assertEqual(len(self.recording.sonar()[1]), len(table("sonar0")))

    def test_every_call_begins_anew(self):
        for first, second in zip(self.recording.imu(), self.recording.imu()):
            np.testing.assert_array_equal(first, second)

    def test_images(self):
        width, height = self.recording.rig.cameras[0].size_px
        images = list(self.recording.images(1))
        lines = [l for l in (SAMPLE / "mav0/cam1/data.csv").read_text().splitlines() if not l.startswith("#")]
        self.assertEqual([t for t, _ in images], [int(line.split(",")[0]) for line in lines])
        self.assertTrue(all(i.shape == (height, width) and i.dtype == np.uint8 for _, i in images))
        self.assertGreater(images[10][1].std(), 5)
        with self.assertRaises(IndexError):
            self.recording.images(2)

    def test_an_image_outlives_its_recording(self):
        stream = lodeline.Recording(SAMPLE).images()
        _, image = next(stream)
        total = int(image.sum())
        del stream
        self.assertEqual(int(image.sum()), total)

    def test_a_damaged_image_is_none_and_a_finding(self):
        camera = self.folder / "mav0/cam0/data"
        camera.mkdir(parents=True)
        (camera / "1000.png").write_bytes(b"no image")
        (camera.parent / "data.csv").write_text("#timestamp [ns],filename\n1000,1000.png\n")
        recording = lodeline.Recording(self.folder)
        self.assertEqual(list(recording.images()), [(1000, None)])
        self.assertIn("image_unreadable", [f.kind for f in recording.findings])

    def test_a_bag_has_the_same_readings(self):
        self.program("convert", SAMPLE, "dive.mcap")
        bag = lodeline.Recording(self.folder / "dive.mcap")
        for ours, theirs in zip(bag.imu(), self.recording.imu()):
            np.testing.assert_array_equal(ours, theirs)
        for ours, theirs in zip(bag.magnetometer(), self.recording.magnetometer()):
            np.testing.assert_allclose(ours, theirs, rtol=1e-12)
        (time, image), (other_time, other) = next(bag.images()), next(self.recording.images())
        self.assertEqual(time, other_time)
        np.testing.assert_array_equal(image, other)
        self.assertEqual(bag.rig.cameras[0].intrinsics_px, self.recording.rig.cameras[0].intrinsics_px)

    def test_rig(self):
        rig = self.recording.rig
        self.assertEqual([c.name for c in rig.cameras], ["cam0", "cam1"])
        self.assertEqual(rig.cameras[0].body_from_camera.shape, (4, 4))
        self.assertIsNotNone(rig.magnetometer)
        self.assertEqual(lodeline.Recording(SAMPLE, cameras=[1]).rig.cameras[0].name, "cam1")

    def test_refusals(self):
        with self.assertRaises(lodeline.InputError):
            lodeline.Recording(self.folder / "none")
        with self.assertRaises(lodeline.UsageError):
            lodeline.Recording(SAMPLE, topics={"cam0": "/x"})


class RobotSensorsTest(FolderTest):
    def write(self, sensor, calibration, table):
        folder = self.folder / "mav0" / sensor
        folder.mkdir(parents=True)
        (folder / "sensor.yaml").write_text("T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n" + calibration)
        (folder / "data.csv").write_text(table)

    def test_altimeter_dvl_and_currents(self):
        times = [10**15 + i * 200_000_000 for i in range(4)]
        noise = "gyroscope_noise_density: 1e-4\ngyroscope_random_walk: 1e-5\n"
        noise += "accelerometer_noise_density: 1e-3\naccelerometer_random_walk: 1e-4\n"
        imu = "".join(f"{10**15 + i * 5_000_000},0,0,0,0,0,9.8\n" for i in range(160))
        self.write("imu0", noise, "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n" + imu)
        self.write("altimeter0", "range_noise_std: 0.05\n",
                   "#timestamp [ns],range [m]\n" + "".join(f"{t},3.5\n" for t in times))
        self.write("dvl0", "velocity_noise_std: 0.01\n", "#timestamp [ns],beam,velocity [mm/s],range [m],valid\n"
                   + "".join(f"{t},{b},{100 * (b + 1)},2.5,{int(b != 2)}\n" for t in times for b in range(4)))
        self.write("current0", "channels: [lamp, thruster]\n", "#timestamp [ns],thruster [A],lamp [mA]\n"
                   + "".join(f"{t},7,250\n" for t in times))
        recording = lodeline.Recording(self.folder)
        self.assertEqual(recording.rig.current_channels, ["lamp", "thruster"])
        np.testing.assert_array_equal(recording.altimeter()[1], [3.5] * 4)
        stamps, velocity, sigma, is_water = recording.dvl()
        np.testing.assert_array_equal(stamps, times)
        self.assertTrue(np.isnan(velocity).all() and np.isnan(sigma).all() and not is_water.any())
        _, beams, along, ranges = recording.dvl_beams()
        np.testing.assert_array_equal(beams[:4], [0, 1, 2, 3])
        np.testing.assert_allclose(along[:4], [0.1, 0.2, np.nan, 0.4])
        np.testing.assert_allclose(ranges[:4], [2.5, 2.5, np.nan, 2.5])
        _, currents = recording.currents()
        np.testing.assert_array_equal(currents["lamp"], [0.25] * 4)
        np.testing.assert_array_equal(currents["thruster"], [7.0] * 4)


class OtherFilesTest(FolderTest):
    def test_depth_profiles(self):
        rows = "\n".join(f"{10 * i},{min(i, 20) * 0.5:.1f}" for i in range(60))
        (self.folder / "dive.csv").write_text("time [s],depth [m]\n" + rows + "\n")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", lodeline.FindingWarning)
            dives = lodeline.read_depth_profiles(self.folder / "dive.csv")
        self.assertEqual(len(dives), 1)
        np.testing.assert_allclose(dives[0]["times_s"][:3], [0, 10, 20])
        self.assertAlmostEqual(dives[0]["depths_m"].max(), 10)

    def test_rig_files(self):
        (self.folder / "rig.yaml").write_text("nonsense: [1\n")
        with self.assertRaisesRegex(lodeline.InputError, "rig.yaml"):
            lodeline.read_rig([self.folder / "rig.yaml"])

    def test_run_folders(self):
        with self.assertRaises(lodeline.InputError):
            lodeline.read_run(self.folder)


class SimulationTest(FolderTest):
    def test_the_same_scenario_is_the_same_recording(self):
        for name in ("a", "b"):
            summary = lodeline.simulate("figure_eight", self.folder / name, seconds=20, seed=5, no_images=True)
        self.assertTrue(summary["complete"])
        a, b = ((self.folder / name / "mav0/imu0/data.csv").read_bytes() for name in ("a", "b"))
        self.assertEqual(a, b)
        self.program("simulate", "figure_eight", "-o", "c", "--seconds", 20, "--seed", 5, "--no-images", "--quiet")
        self.assertEqual(a, (self.folder / "c/mav0/imu0/data.csv").read_bytes())

    def test_progress_stops_and_goes_on(self):
        options = {"seconds": 20, "width_px": 160, "camera_rate_hz": 2, "cameras": 1}
        first = lodeline.simulate("demo", self.folder / "d", progress=lambda done, total: done < 1, threads=1, **options)
        self.assertFalse(first["complete"])
        with self.assertRaisesRegex(LookupError, "mine"):
            def fail(*_):
                raise LookupError("mine")
            lodeline.simulate("demo", self.folder / "d", progress=fail, threads=1, **options)
        self.assertTrue(lodeline.simulate("demo", self.folder / "d", **options)["complete"])

    def test_refusals(self):
        for arguments in ({"metre": 3}, {"effects": {"no_effect": True}}, {"seconds": -1}):
            with self.assertRaises(lodeline.UsageError):
                lodeline.simulate("demo", self.folder / "d", **arguments)
        with self.assertRaises(lodeline.UsageError):
            lodeline.simulate("nowhere", self.folder / "d")
        self.assertIn("demo", lodeline.scenarios())
        self.assertIn("flat_port", lodeline.effects())


if __name__ == "__main__":
    unittest.main()
