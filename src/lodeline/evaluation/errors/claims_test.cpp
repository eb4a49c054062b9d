#include "lodeline/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/evaluation/trajectory/test_trajectories.h"

namespace lodeline {
namespace {

/// The poses of a trajectory with the same sigmas for all.
ReportedUncertainty claimsOf(const Trajectory& trajectory, double position_sigma_m,
                             double rotation_sigma_rad) {
  ReportedUncertainty claims;
  for (const StampedPose& pose : trajectory.poses) {
    claims.poses.push_back({pose, Vec3::Constant(position_sigma_m), Vec3::Constant(rotation_sigma_rad)});
  }
  return claims;
}

TEST(Claims, CountWhatLiesWithinAndWeighByTheSigma) {
  const Trajectory truth = test::bend(101);
  Trajectory estimate = truth;
  for (size_t i = 1; i < estimate.size(); ++i) {
    Rigid3& pose = estimate.poses[i].world_from_body;
    pose.translation += Vec3(0.02, i <= 25 ? 0.05 : 0.0, 0.0);
    pose.rotation = Quat(Eigen::AngleAxisd(0.03, Vec3::UnitZ())) * pose.rotation;
  }
  const ConsistencyCheck check = checkConsistency(claimsOf(estimate, 0.01, 0.02), truth, {});
  EXPECT_EQ(check.poses, 100u);
  EXPECT_NEAR(check.position.within_3_sigma_percent.x(), 100.0, 1e-9);
  EXPECT_NEAR(check.position.within_3_sigma_percent.y(), 75.0, 1e-9);
  EXPECT_NEAR(check.position.rms_sigmas.x(), 2.0, 1e-6);
  EXPECT_NEAR(check.position.rms_sigmas.y(), 5.0 * std::sqrt(0.25), 1e-6);
  EXPECT_NEAR(check.position.rms_sigmas.z(), 0.0, 1e-6);
  EXPECT_NEAR(check.rotation.rms_sigmas.z(), 1.5, 1e-6);
  EXPECT_NEAR(check.rotation.rms_sigmas.x(), 0.0, 1e-6);
}

TEST(Claims, AreNotAboutTheStartButAboutNorthWhereItIsClaimed) {
  const Trajectory truth = test::bend(101);
  const Trajectory turned =
      test::transformed(truth, Rigid3(Quat(Eigen::AngleAxisd(0.1, Vec3::UnitZ())), Vec3(3.0, -2.0, 1.0)));
  ReportedUncertainty claims = claimsOf(turned, 0.01, 0.05);
  EXPECT_LT(checkConsistency(claims, truth, {}).rotation.rms_sigmas.norm(), 1e-6);
  EXPECT_LT(checkConsistency(claims, truth, {}).position.rms_sigmas.norm(), 1e-6);
  claims.basis = HeadingBasis::North;
  EXPECT_NEAR(checkConsistency(claims, truth, {}).rotation.rms_sigmas.z(), 2.0, 1e-6);
  EXPECT_GT(checkConsistency(claims, truth, {}).position.rms_sigmas.x(), 1.0);
}

TEST(Claims, AreInTheAxesOfTheWorldThatTheEstimateChose) {
  const Trajectory truth = test::bend(101);
  Trajectory estimate =
      test::transformed(truth, Rigid3(Quat(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitZ())), Vec3::Zero()));
  for (size_t i = 1; i < estimate.size(); ++i) {
    estimate.poses[i].world_from_body.translation.x() += 0.05;
    estimate.poses[i].world_from_body.rotation =
        Quat(Eigen::AngleAxisd(0.02, Vec3::UnitY())) * estimate.poses[i].world_from_body.rotation;
  }
  ReportedUncertainty claims = claimsOf(estimate, 0.01, 0.02);
  for (ReportedPose& claim : claims.poses) {
    claim.position_sigma_m.x() = 0.05;
    claim.rotation_sigma_rad.y() = 0.01;
  }
  const ConsistencyCheck check = checkConsistency(claims, truth, {});
  EXPECT_NEAR((check.position.rms_sigmas - Vec3(1.0, 0.0, 0.0)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((check.rotation.rms_sigmas - Vec3(0.0, 2.0, 0.0)).norm(), 0.0, 1e-6);
}

TEST(Claims, WithoutTimesOrPosesThereIsNothingToJudge) {
  Trajectory truth = test::bend(20);
  EXPECT_EQ(checkConsistency({}, truth, {}).poses, 0u);
  const ReportedUncertainty claims = claimsOf(truth, 0.01, 0.01);
  truth.time_base = TimeBase::Index;
  EXPECT_EQ(checkConsistency(claims, truth, {}).poses, 0u);
}

}  // namespace
}  // namespace lodeline
