import json
import unittest
import warnings

import lodeline
import numpy as np
from support import SAMPLE, FolderTest


def rotation(axis, angle):
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def helix(count=200):
    """Poses every 50 ms on a helix, at times of today."""
    times = 1_700_000_000_123_456_789 + np.arange(count) * 50_000_000
    poses = np.tile(np.eye(4), (count, 1, 1))
    for i, pose in enumerate(poses):
        angle = 0.05 * i
        pose[:3, :3] = rotation([0, 0, 1], angle) @ rotation([1, 0, 0], 0.3)
        pose[:3, 3] = [5 * np.cos(angle), 5 * np.sin(angle), 0.02 * i]
    return times, poses


class TrajectoryTest(FolderTest):
    def test_tum_gives_the_poses_back(self):
        times, poses = helix()
        lodeline.Trajectory(times, poses).write_tum(self.folder / "a.tum")
        back = lodeline.read_trajectory(self.folder / "a.tum")
        np.testing.assert_array_equal(back.times_ns, times)
        np.testing.assert_allclose(back.poses, poses, atol=1e-8)
        self.assertTrue(back.has_times)
        self.assertAlmostEqual(back.path_length_m, np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1).sum())

    def test_kitti_and_euroc(self):
        times, poses = helix(30)
        np.savetxt(self.folder / "kitti.txt", poses[:, :3].reshape(30, 12))
        kitti = lodeline.read_trajectory(self.folder / "kitti.txt", format="kitti")
        np.testing.assert_allclose(kitti.poses, poses, atol=1e-9)
        self.assertFalse(kitti.has_times)
        self.assertEqual(kitti.up, "-y")
        truth = lodeline.read_trajectory(SAMPLE / "mav0/state_groundtruth_estimate0")
        table = np.loadtxt(SAMPLE / "mav0/state_groundtruth_estimate0/data.csv", delimiter=",")
        np.testing.assert_allclose(truth.positions, table[:, 1:4])
        np.testing.assert_allclose(np.abs(np.sum(truth.quaternions * table[:, 4:8], axis=1)), 1, atol=1e-8)
        self.assertTrue(np.all(truth.quaternions[:, 0] >= 0))

    def test_order_and_doubles(self):
        times, poses = helix(10)
        with self.assertWarnsRegex(lodeline.FindingWarning, "trajectory_disorder"):
            turned = lodeline.Trajectory(times[::-1], poses[::-1])
        np.testing.assert_array_equal(turned.times_ns, times)
        with self.assertWarnsRegex(lodeline.FindingWarning, "trajectory_duplicate"):
            self.assertEqual(len(lodeline.Trajectory(np.repeat(times, 2), np.repeat(poses, 2, axis=0))), 10)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            lodeline.Trajectory(times, poses)
            with self.assertRaises(lodeline.FindingWarning):
                lodeline.Trajectory(times[::-1], poses[::-1])

    def test_refusals(self):
        times, poses = helix(10)
        with self.assertRaises(TypeError):
            lodeline.Trajectory(times * 1e-9, poses)
        with self.assertRaises(ValueError):
            lodeline.Trajectory(times, poses[:5])
        with self.assertRaises(lodeline.InputError):
            lodeline.Trajectory(times, 1.1 * poses)
        with self.assertRaises(lodeline.UsageError):
            lodeline.Trajectory(times, poses, up="y")
        with self.assertRaises(lodeline.UsageError):
            lodeline.read_trajectory("x", format="excel")
        (self.folder / "bad.tum").write_text("1 2 3\n")
        with self.assertRaisesRegex(lodeline.InputError, "bad.tum"):
            lodeline.read_trajectory(self.folder / "bad.tum")


class EvaluationTest(FolderTest):
    def test_a_moved_trajectory_has_no_error(self):
        times, poses = helix()
        move = np.eye(4)
        move[:3, :3], move[:3, 3] = rotation([0.2, 0.3, 1], 0.7), [10, -20, 30]
        result = lodeline.evaluate(lodeline.Trajectory(times, move @ poses), lodeline.Trajectory(times, poses))
        self.assertLess(result.ate_rmse_m, 1e-9)
        self.assertLess(result.rotation_rmse_deg, 1e-5)
        np.testing.assert_allclose(result.aligned_poses, poses, atol=1e-9)
        yaw = lodeline.evaluate(lodeline.Trajectory(times, move @ poses), lodeline.Trajectory(times, poses), align="yaw")
        self.assertGreater(yaw.ate_rmse_m, 0.1)

    def test_scale(self):
        times, poses = helix()
        larger = poses.copy()
        larger[:, :3, 3] *= 1.1
        result = lodeline.evaluate(lodeline.Trajectory(times, larger), lodeline.Trajectory(times, poses), align="sim3")
        self.assertAlmostEqual(result.scale_error, 0.1)
        self.assertLess(result.ate_rmse_m, 1e-9)

    def test_errors_follow_their_definition(self):
        times, poses = helix()
        noisy = poses.copy()
        noise = np.random.default_rng(1).normal(0, 0.05, (len(poses), 3))
        noisy[:, :3, 3] += noise
        result = lodeline.evaluate(lodeline.Trajectory(times, noisy), lodeline.Trajectory(times, poses), align="none",
                                   stretches_m=[2.0])
        np.testing.assert_allclose(result.position_errors_m, noise, atol=1e-9)
        self.assertAlmostEqual(result.ate_rmse_m, np.sqrt(np.mean(np.sum(noise**2, axis=1))))
        np.testing.assert_array_equal(result.times_ns, times)
        self.assertEqual([row["length_m"] for row in result.relative], [2.0])
        self.assertGreater(len(result.relative[0]["translation_m"]), 50)
        self.assertEqual(result.distances_m.shape, (len(times),))
        self.assertEqual(result.rotation_errors_deg.shape, result.yaw_errors_deg.shape)

    def test_time_offset(self):
        times, poses = helix()
        late = lodeline.Trajectory(times + 200_000_000, poses)
        result = lodeline.evaluate(late, lodeline.Trajectory(times, poses), align="none", time_offset_s=-0.2)
        self.assertLess(result.ate_rmse_m, 1e-9)
        with self.assertRaises(lodeline.InputError):
            lodeline.evaluate(lodeline.Trajectory(times + 10**15, poses), lodeline.Trajectory(times, poses))

    def test_figures_are_those_of_the_program(self):
        lodeline.run(SAMPLE, self.folder / "run", settings={"source.duration_s": 5})
        truth = SAMPLE / "mav0/state_groundtruth_estimate0"
        self.program("evaluate", "run", truth, "--align", "yaw", "--json", "theirs.json")
        result = lodeline.evaluate(self.folder / "run", truth, align="yaw")
        theirs = json.loads((self.folder / "theirs.json").read_text())
        ours = result.figures
        self.assertEqual(theirs.keys(), ours.keys())
        differing = [key for key in theirs if theirs[key] != ours[key]]
        self.assertLessEqual(set(differing), {"estimate", "reference", "inputs"}, differing)
        self.assertIn("position", str(result).lower())


if __name__ == "__main__":
    unittest.main()
