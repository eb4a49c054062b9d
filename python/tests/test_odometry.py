import unittest

import lodeline
import numpy as np
from support import SAMPLE, FolderTest

# Readings of the sonar are not pushed here.
SETTINGS = {"source.duration_s": 5, "sonar.use": False}


def start(recording, seconds):
    """The streams of the first seconds."""
    images = [[(t, i) for t, i in recording.images(camera)] for camera in range(len(recording.rig.cameras))]
    end = images[0][0][0] + int(seconds * 1e9)
    images = [[(t, i) for t, i in stream if t <= end] for stream in images]
    cut = lambda arrays: tuple(a[: np.searchsorted(arrays[0], end + 100_000_000)] for a in arrays)
    return {"images": images, "imu": cut(recording.imu()), "magnetometer": cut(recording.magnetometer()),
            "depth": cut(recording.depth())}


class FeedTest(FolderTest):
    @classmethod
    def setUpClass(cls):
        cls.recording = lodeline.Recording(SAMPLE)
        cls.streams = start(cls.recording, 5.0)

    def test_poses_are_those_of_the_recording(self):
        odometry = lodeline.Odometry(self.recording.rig)
        estimates = lodeline.feed(odometry, **self.streams)
        result = lodeline.run(SAMPLE, settings=SETTINGS)
        count = min(len(estimates), len(result.estimates)) - 2
        self.assertGreater(count, 20)
        np.testing.assert_array_equal(estimates.times_ns[:count], result.estimates.times_ns[:count])
        np.testing.assert_allclose(estimates.positions[:count], result.estimates.positions[:count], atol=2e-3)
        self.assertIsInstance(odometry.findings, list)

    def test_same_readings_same_poses(self):
        first, second = (lodeline.feed(lodeline.Odometry(self.recording.rig), **self.streams) for _ in range(2))
        np.testing.assert_array_equal(first.poses, second.poses)
        np.testing.assert_array_equal(first.pose_covariances, second.pose_covariances)

    def test_a_changed_array_changes_nothing(self):
        def reused(stream):
            buffer = np.empty_like(stream[0][1])
            for time_ns, image in stream:
                buffer[:] = image
                yield time_ns, buffer

        streams = {**self.streams, "images": [reused(s) for s in self.streams["images"]]}
        first = lodeline.feed(lodeline.Odometry(self.recording.rig), **self.streams)
        second = lodeline.feed(lodeline.Odometry(self.recording.rig), **streams)
        np.testing.assert_array_equal(first.poses, second.poses)

    def test_a_rig_by_hand(self):
        theirs = self.recording.rig
        cameras = [lodeline.Camera(size_px=c.size_px, intrinsics_px=c.intrinsics_px, model=c.model, distortion=c.distortion,
                                   body_from_camera=c.body_from_camera, time_offset_s=c.time_offset_s) for c in theirs.cameras]
        rig = lodeline.Rig(cameras=cameras, imu=lodeline.Imu(gyroscope_density=theirs.imu.gyroscope_density,
                                                              accelerometer_density=theirs.imu.accelerometer_density))
        self.assertEqual([c.name for c in rig.cameras], ["cam0", "cam1"])
        self.assertIsNone(rig.magnetometer)
        streams = {key: self.streams[key] for key in ("images", "imu")}
        self.assertGreater(len(lodeline.feed(lodeline.Odometry(rig), **streams)), 20)

    def test_estimates_can_be_taken_while_it_goes_on(self):
        odometry = lodeline.Odometry(self.recording.rig)
        taken = []
        original = odometry.push_image

        class Taking:
            def __getattr__(self, name):
                return getattr(odometry, name)

            def push_image(self, *arguments):
                original(*arguments)
                taken.extend(odometry.take())

        estimates = lodeline.feed(Taking(), **self.streams)
        taken.extend(odometry.take())
        posed = [e for e in taken if e.has_pose]
        self.assertEqual([e.time_ns for e in posed], list(estimates.times_ns))


class RefusalTest(unittest.TestCase):
    def setUp(self):
        self.rig = lodeline.Recording(SAMPLE).rig
        self.odometry = lodeline.Odometry(self.rig)
        width, height = self.rig.cameras[0].size_px
        self.image = np.zeros((height, width), np.uint8)

    def test_times_in_seconds(self):
        with self.assertRaisesRegex(TypeError, "nanoseconds"):
            self.odometry.push_imu(1.5, [0, 0, 0], [0, 0, 9.8])
        with self.assertRaisesRegex(TypeError, "nanoseconds"):
            self.odometry.push_magnetometer(np.array([1.5]), [[0, 0, 5e-5]])

    def test_shapes(self):
        for rates, forces in (([0, 0], [0, 0, 9.8]), ([[0, 0, 0]] * 3, [[0, 0, 9.8]] * 2), ([0, 0, 0], [[[0, 0, 9.8]]])):
            with self.assertRaisesRegex(ValueError, "wanted shape"):
                self.odometry.push_imu(np.array([1, 2]), rates, forces)
        with self.assertRaisesRegex(ValueError, "depth_m"):
            self.odometry.push_depth(np.array([1, 2]), [1.0])

    def test_images(self):
        with self.assertRaisesRegex(TypeError, "uint8"):
            self.odometry.push_image(0, 1, self.image.astype(float))
        with self.assertRaisesRegex(ValueError, "grey"):
            self.odometry.push_image(0, 1, np.stack([self.image] * 3, axis=-1))
        with self.assertRaisesRegex(lodeline.InputError, "cam0"):
            self.odometry.push_image(0, 1, self.image.T)
        with self.assertRaisesRegex(lodeline.UsageError, "camera 2"):
            self.odometry.push_image(2, 1, self.image)

    def test_images_without_inertial_readings(self):
        with self.assertRaisesRegex(lodeline.UsageError, "order of their times"):
            for i in range(1000):
                self.odometry.push_image(0, i * 50_000_000, self.image)

    def test_nothing_pushed(self):
        with self.assertRaises(lodeline.EstimationError):
            self.odometry.finish()

    def test_after_the_end(self):
        with self.assertRaises(lodeline.UsageError):
            self.odometry.findings
        with self.assertRaises(lodeline.Error):
            self.odometry.finish()
        with self.assertRaises(lodeline.Error):
            self.odometry.push_imu(1, [0, 0, 0], [0, 0, 9.8])

    def test_settings(self):
        with self.assertRaises(lodeline.UsageError):
            lodeline.Odometry(self.rig, settings={"no.key": 1})
        with self.assertRaises(lodeline.UsageError):
            lodeline.Odometry(self.rig, patience_s=0)

    def test_a_matrix_that_is_no_pose(self):
        with self.assertRaises(lodeline.InputError):
            lodeline.Camera(size_px=(10, 10), intrinsics_px=(5, 5, 5, 5), body_from_camera=2 * np.eye(4))


if __name__ == "__main__":
    unittest.main()
