#include "lodeline/evaluation/trajectory/azimuth_correction.h"

#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

const double kDeclination = -6.4 * kDegree;
const Vec3 kField_W(24e-6 * std::sin(kDeclination), 24e-6 * std::cos(kDeclination), -38e-6);

/// Readings of an exact magnetometer along the true trajectory, halfway between its poses.
std::vector<StampedField> fieldAlong(const Trajectory& truth) {
  std::vector<StampedField> field;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const StampedPose& before = truth.poses[i - 1];
    const StampedPose& after = truth.poses[i];
    const Quat middle = before.world_from_body.rotation.slerp(0.5, after.world_from_body.rotation);
    const Duration half = Duration::fromSeconds(0.5 * (after.time - before.time).seconds());
    field.push_back({before.time + half, middle.conjugate() * kField_W});
  }
  return field;
}

/// The true trajectory by an odometry whose heading starts at `start_rad` and drifts by `rate_rad_per_s`:
/// steps and attitudes are rotated about the vertical.
Trajectory drifting(const Trajectory& truth, double start_rad, double rate_rad_per_s) {
  Trajectory odometry = truth;
  double before_rad = start_rad;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double time_s = (truth.poses[i].time - truth.poses[0].time).seconds();
    const double yaw_rad = start_rad + rate_rad_per_s * time_s;
    Rigid3& pose = odometry.poses[i].world_from_body;
    pose.rotation = Quat(Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ())) * pose.rotation;
    if (i > 0) {
      const Quat middle(Eigen::AngleAxisd(0.5 * (yaw_rad + before_rad), Vec3::UnitZ()));
      pose.translation = odometry.poses[i - 1].world_from_body.translation +
                         middle * (truth.poses[i].world_from_body.translation -
                                   truth.poses[i - 1].world_from_body.translation);
    }
    before_rad = yaw_rad;
  }
  return odometry;
}

std::vector<Rigid3> posesOf(const Trajectory& trajectory) {
  std::vector<Rigid3> poses;
  for (const StampedPose& pose : trajectory.poses) poses.push_back(pose.world_from_body);
  return poses;
}

AbsoluteErrors errors(const Trajectory& estimate, const Trajectory& truth) {
  return computeAbsoluteErrors(posesOf(estimate), posesOf(truth));
}

const AzimuthCorrectionOptions kTrueNorth{.field_azimuth_rad = kDeclination};

TEST(AzimuthCorrection, TurnsAWholeTrajectoryToTrueNorth) {
  const Trajectory truth = test::bend(600);
  // Nearly the opposite direction: the angles of the readings are on both sides of the discontinuity at 180
  // degrees.
  const Trajectory odometry = drifting(truth, 179.9 * kDegree, 0.0);
  const AbsoluteErrors left = errors(correctHeadingByAzimuth(odometry, fieldAlong(truth), kTrueNorth), truth);
  // The attitude at the reading is interpolated over 0.1 s of a rotating body.
  EXPECT_LT(left.rotation().max, 1e-2);
  EXPECT_LT(left.position().max, 1e-3);
}

TEST(AzimuthCorrection, TakesOutSlowDriftAndKeepsRollPitchAndHeight) {
  const Trajectory truth = test::bend(1200);
  const Trajectory odometry = drifting(truth, 0.3, 0.05 * kDegree);
  ASSERT_GT(errors(odometry, truth).yaw().max, 20.0);
  const Trajectory corrected = correctHeadingByAzimuth(odometry, fieldAlong(truth), kTrueNorth);
  const AbsoluteErrors left = errors(corrected, truth);
  // Within half a window of an end the centre of the median is up to 5 s away from the pose: 0.25 degrees of
  // drift.
  EXPECT_LT(left.yaw().max, 0.27);
  EXPECT_LT(left.yaw().median, 0.01);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR(corrected.poses[i].world_from_body.translation.z(),
                odometry.poses[i].world_from_body.translation.z(), 1e-9);
    const Vec3 up_B = corrected.poses[i].world_from_body.rotation.conjugate() * Vec3::UnitZ();
    const Vec3 up_before_B = odometry.poses[i].world_from_body.rotation.conjugate() * Vec3::UnitZ();
    EXPECT_LT((up_B - up_before_B).norm(), 1e-9);
  }
}

TEST(AzimuthCorrection, MedianPassesOverADisturbanceShorterThanHalfTheWindow) {
  const Trajectory truth = test::bend(600);
  std::vector<StampedField> field = fieldAlong(truth);
  for (std::size_t i = 200; i < 280; ++i) field[i].field_B = -field[i].field_B;
  EXPECT_LT(errors(correctHeadingByAzimuth(truth, field, kTrueNorth), truth).yaw().max, 1e-2);
}

TEST(AzimuthCorrection, SilenceOfTheMagnetometerKeepsTheLastCorrection) {
  const Trajectory truth = test::bend(900);
  const Trajectory odometry = drifting(truth, 0.5, 0.0);
  std::vector<StampedField> field = fieldAlong(truth);
  field.erase(field.begin(), field.begin() + 250);
  field.erase(field.begin() + 100, field.end());
  EXPECT_LT(errors(correctHeadingByAzimuth(odometry, field, kTrueNorth), truth).yaw().max, 1e-2);
}

TEST(AzimuthCorrection, WithoutReadingsThereIsNothingToCorrectBy) {
  const Trajectory truth = test::bend(50);
  EXPECT_THROW(correctHeadingByAzimuth(truth, {}, {}), InputError);
  const Trajectory later = test::bend(50, 1000.0);
  EXPECT_THROW(correctHeadingByAzimuth(truth, fieldAlong(later), {}), InputError);
}

}  // namespace
}  // namespace lodeline
