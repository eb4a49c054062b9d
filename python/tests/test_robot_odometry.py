"""Readings of a vehicle's sensors, pushed by hand and from a folder."""

import shutil
import unittest

import lodeline
import numpy as np
from support import SAMPLE, FolderTest

SETTINGS = {"source.duration_s": 5, "magnetometer.model": "absolute"}
IDENTITY = "T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n"


def beams():
    side, along = np.sin(np.deg2rad(22.5)) / np.sqrt(2), np.cos(np.deg2rad(22.5))
    return np.array([[side, side, along], [-side, side, along], [-side, -side, along], [side, -side, along]])


def rotations(quaternions):
    """Matrices of unit quaternions w, x, y, z."""
    w, x, y, z = quaternions.T
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    return np.moveaxis(np.array(rows), -1, 0)


class RobotFeedTest(FolderTest):
    """The sample dive, with a DVL by its truth, an altimeter and two currents."""

    def setUp(self):
        super().setUp()
        shutil.copytree(SAMPLE / "mav0", self.folder / "mav0", ignore=shutil.ignore_patterns("state_*"))
        table = np.loadtxt(SAMPLE / "mav0/state_groundtruth_estimate0/data.csv", delimiter=",", dtype=str)
        times, numbers = table[:, 0].astype(np.int64), table[:, 1:].astype(float)
        every = max(1, round(0.2e9 / np.median(np.diff(times))))
        self.times = times[::every]
        velocities = np.einsum("nji,nj->ni", rotations(numbers[::every, 3:7]), numbers[::every, 7:10])
        noise = np.random.default_rng(1).normal(0, 0.005, (len(self.times), 4))
        along = velocities @ beams().T + noise
        rows = [f"{t},{b},{along[i, b]:.6f},{2.5 + 0.1 * b:.2f},{int((i + b) % 7 != 0)}"
                for i, t in enumerate(self.times) for b in range(4)]
        self.write("dvl0", "velocity_noise_std: 0.01\n", "#timestamp [ns],beam,velocity [m/s],range [m],valid", rows)
        self.write("altimeter0", "range_noise_std: 0.05\n", "#timestamp [ns],range [m]", [f"{t},1.5" for t in self.times])
        self.write("current0", "channels: [thruster, lamp]\n", "#timestamp [ns],lamp [A],thruster [A]",
                   [f"{t},{i % 20 // 10},{4 + np.sin(0.3 * i):.4f}" for i, t in enumerate(self.times)])
        self.recording = lodeline.Recording(self.folder)
        self.images = [list(self.recording.images(camera)) for camera in range(2)]
        self.end = self.images[0][0][0] + 5_000_000_000
        self.images = [[item for item in stream if item[0] <= self.end] for stream in self.images]

    def write(self, sensor, calibration, header, rows):
        folder = self.folder / "mav0" / sensor
        folder.mkdir(parents=True)
        (folder / "sensor.yaml").write_text(IDENTITY + calibration)
        (folder / "data.csv").write_text("\n".join([header, *rows]) + "\n")

    def streams(self):
        """All readings of the first seconds."""
        def cut(arrays):
            keep = arrays[0] <= self.end + 100_000_000
            return tuple(a[keep] for a in arrays)

        times, currents = self.recording.currents()
        keep = times <= self.end + 100_000_000
        return {"imu": cut(self.recording.imu(corrected=False)), "images": self.images,
                "magnetometer": cut(self.recording.magnetometer()), "depth": cut(self.recording.depth()),
                "sonar": cut(self.recording.sonar()), "altimeter": cut(self.recording.altimeter()),
                "dvl": cut(self.recording.dvl()), "dvl_beams": cut(self.recording.dvl_beams()),
                "currents": (times[keep], {name: values[keep] for name, values in currents.items()})}

    def feed(self, **streams):
        odometry = lodeline.Odometry(self.recording.rig, settings={"magnetometer.model": "absolute"})
        return lodeline.feed(odometry, **streams)

    def test_the_same_bytes_as_from_the_folder(self):
        pushed = self.feed(**self.streams())
        seen = {}
        result = lodeline.run(self.folder, settings=SETTINGS, check=False,
                              progress=lambda e: seen.setdefault(e.sensors["dvl"]["dvl"], e.time_ns) and None)
        self.assertIn("used", seen)
        count = min(len(pushed), len(result.estimates)) - 2
        self.assertGreater(count, 20)
        for name in ("times_ns", "positions", "quaternions", "velocities", "pose_covariances", "heading_sigmas"):
            ours, theirs = (getattr(e, name)[:count] for e in (pushed, result.estimates))
            self.assertEqual(ours.tobytes(), theirs.tobytes(), name)

    def test_every_sensor_counts(self):
        streams = self.streams()
        everything = self.feed(**streams)
        for left_out in (("dvl", "dvl_beams"), ("currents",)):
            others = self.feed(**{name: stream for name, stream in streams.items() if name not in left_out})
            self.assertFalse(np.array_equal(everything.positions, others.positions), left_out)

    def test_beams_without_velocities_of_the_ping(self):
        streams = self.streams()
        beams_alone = self.feed(**{name: stream for name, stream in streams.items() if name != "dvl"})
        self.assertEqual(beams_alone.poses.tobytes(), self.feed(**streams).poses.tobytes())


class RobotRefusalTest(unittest.TestCase):
    def setUp(self):
        camera = lodeline.Camera(size_px=(64, 48), intrinsics_px=(50, 50, 32, 24))
        self.rig = lodeline.Rig(cameras=[camera], sonar=lodeline.Sonar(max_range_m=20), altimeter=lodeline.Sonar(),
                                dvl=lodeline.Dvl(beams=2 * beams(), scale_sigma=0.002),
                                currents=lodeline.CurrentSensor(channels=["lamp", "thruster"], fields=np.eye(3)[:2] * 1e-7))
        self.bare = lodeline.Odometry(lodeline.Rig(cameras=[camera]))
        self.odometry = lodeline.Odometry(self.rig)

    def test_the_rig(self):
        np.testing.assert_allclose(np.linalg.norm(self.rig.dvl.beams, axis=1), 1)
        self.assertEqual(self.rig.current_channels, ["lamp", "thruster"])
        self.assertEqual(self.rig.currents.fields.shape, (2, 3))
        self.assertEqual((self.rig.sonar.max_range_m, self.rig.has_altimeter), (20, True))
        for make in (lambda: lodeline.Dvl(beams=[[0, 0, 0]]), lambda: lodeline.Dvl(beams=[[0, 1]]),
                     lambda: lodeline.CurrentSensor(channels=["lamp"], fields=np.zeros((2, 3)))):
            with self.assertRaises(ValueError):
                make()

    def test_sensors_that_the_rig_does_not_have(self):
        pushes = {"sonar": lambda o: o.push_sonar(1, 2.0, 0.1), "altimeter": lambda o: o.push_altimeter(1, 2.0),
                  "DVL": lambda o: o.push_dvl(1, [0.1, 0, 0]), "magnetometer": lambda o: o.push_magnetometer(1, [0, 0, 5e-5]),
                  "pressure": lambda o: o.push_depth(1, 3.0)}
        for name, push in pushes.items():
            with self.assertRaisesRegex(lodeline.UsageError, name):
                push(self.bare)
        with self.assertRaisesRegex(lodeline.UsageError, "lamp"):
            self.bare.push_currents(1, {"lamp": 1.0})

    def test_one_reading_as_a_driver_has_it(self):
        self.odometry.push_sonar(1, 2.0, 0.1)
        self.odometry.push_altimeter(1, 2.0)
        self.odometry.push_dvl(1, [0.1, 0, 0], 0.01, False)
        self.odometry.push_dvl(2, beam_velocity=[0.1, np.nan, 0.2, 0.3], beam_range=[2, np.nan, 2, 2])
        self.odometry.push_dvl(3, [0.1, 0, 0], is_water_track=True)
        self.odometry.push_currents(1, {"thruster": 3.0, "lamp": 0})

    def test_times_and_shapes(self):
        two = np.array([1, 2])
        with self.assertRaisesRegex(TypeError, "nanoseconds"):
            self.odometry.push_dvl(0.5, [0.1, 0, 0])
        for arguments in ({"velocity": [[0.1, 0, 0]]}, {"velocity": np.zeros((2, 3)), "sigma": [0.1]},
                          {"velocity": np.zeros((2, 3)), "is_water_track": [True]}, {"beam_velocity": [0.1, 0.2]},
                          {"beam_velocity": np.zeros((2, 4)), "beam_range": np.zeros((2, 3))}, {}):
            with self.assertRaises(ValueError, msg=arguments):
                self.odometry.push_dvl(two, **arguments)
        with self.assertRaises(TypeError):
            self.odometry.push_dvl(two, np.zeros((2, 3)), is_water_track=[0.5, 1.0])
        for ranges, angles in (([1.0], [0.0, 0.1]), ([1.0, 2.0], [0.0])):
            with self.assertRaises(ValueError):
                self.odometry.push_sonar(two, ranges, angles)
        with self.assertRaises(ValueError):
            self.odometry.push_currents(two, {"lamp": [1.0, 2.0], "thruster": [1.0]})

    def test_names_of_channels(self):
        with self.assertRaisesRegex(lodeline.UsageError, "thruster"):
            self.odometry.push_currents(1, {"lamp": 1.0})
        with self.assertRaisesRegex(lodeline.UsageError, "lamb"):
            self.odometry.push_currents(1, {"lamb": 1.0, "lamp": 1.0, "thruster": 0.0})
        with self.assertRaises(TypeError):
            self.odometry.push_currents(1, {"lamp": "bright", "thruster": 0.0})

    def test_beams_at_times_without_a_ping(self):
        dvl = (np.array([1, 5]), np.zeros((2, 3)), np.full(2, 0.01), np.zeros(2, bool))
        beam = (np.array([3]), np.array([0]), np.array([0.1]), np.array([2.0]))
        imu = (np.array([1]), np.zeros((1, 3)), np.zeros((1, 3)))
        with self.assertRaisesRegex(ValueError, "dvl_beams"):
            lodeline.feed(self.odometry, imu=imu, images=[], dvl=dvl, dvl_beams=beam)


if __name__ == "__main__":
    unittest.main()
