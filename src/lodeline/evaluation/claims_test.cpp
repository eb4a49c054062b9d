#include "lodeline/evaluation/claims.h"

#include <gtest/gtest.h>

#include <fstream>

#include "lodeline/base/error.h"
#include "lodeline/evaluation/test_trajectories.h"

namespace lodeline {
namespace {

/// The poses of a trajectory with the same sigmas for all.
RunClaims claimsOf(const Trajectory& trajectory, double position_sigma_m, double rotation_sigma_rad) {
  RunClaims claims;
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
  const ClaimCheck check = checkClaims(claimsOf(estimate, 0.01, 0.02), truth, {});
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
  RunClaims claims = claimsOf(turned, 0.01, 0.05);
  EXPECT_LT(checkClaims(claims, truth, {}).rotation.rms_sigmas.norm(), 1e-6);
  EXPECT_LT(checkClaims(claims, truth, {}).position.rms_sigmas.norm(), 1e-6);
  claims.basis = HeadingBasis::North;
  EXPECT_NEAR(checkClaims(claims, truth, {}).rotation.rms_sigmas.z(), 2.0, 1e-6);
  EXPECT_GT(checkClaims(claims, truth, {}).position.rms_sigmas.x(), 1.0);
}

TEST(Claims, WithoutTimesOrPosesThereIsNothingToJudge) {
  Trajectory truth = test::bend(20);
  EXPECT_EQ(checkClaims({}, truth, {}).poses, 0u);
  const RunClaims claims = claimsOf(truth, 0.01, 0.01);
  truth.time_base = TimeBase::Index;
  EXPECT_EQ(checkClaims(claims, truth, {}).poses, 0u);
}

class ClaimFiles : public testing::Test {
 protected:
  void write(const char* name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
  }

  test::TemporaryFolder folder_;
};

constexpr const char* kHeader =
    "#timestamp [ns],status,p_x [m],p_y [m],p_z [m],q_w,q_x,q_y,q_z,sigma_p_x [m],sigma_p_y [m],"
    "sigma_p_z [m],sigma_theta_x [rad],sigma_theta_y [rad],sigma_theta_z [rad],sigma_heading [rad]\n";

TEST_F(ClaimFiles, AreReadAsFarAsTheyGo) {
  write("states.csv", std::string(kHeader) +
                          "1000000000,attitude,nan,nan,nan,nan,nan,nan,nan,nan,nan,nan,nan,nan,nan,nan\n"
                          "2000000000,tracking,1,2,3,1,0,0,0,0.1,0.2,0.3,0.4,0.5,0.6,0.7\n"
                          "3000000000,tracking,1,2,3,1,0,0,0,0.1,0.2,0.");
  write("run.json", R"({"heading": {"reference": "true north"}})");
  const RunClaims claims = readClaims(folder_.path());
  EXPECT_EQ(claims.basis, HeadingBasis::North);
  ASSERT_EQ(claims.poses.size(), 1u);
  EXPECT_EQ(claims.poses[0].pose.time, Time::fromSeconds(2.0));
  EXPECT_EQ(claims.poses[0].pose.world_from_body.translation, Vec3(1, 2, 3));
  EXPECT_EQ(claims.poses[0].position_sigma_m, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(claims.poses[0].rotation_sigma_rad, Vec3(0.4, 0.5, 0.7)) << "z is the heading's";
}

TEST_F(ClaimFiles, OfAnotherKindAreRefusedAndNoneIsNone) {
  EXPECT_TRUE(readClaims(folder_.path()).poses.empty());
  write("states.csv", "#timestamp [ns],status\n");
  EXPECT_THROW(readClaims(folder_.path()), InputError);
  write("states.csv", kHeader);
  write("run.json", "{");
  EXPECT_THROW(readClaims(folder_.path()), InputError);
}

}  // namespace
}  // namespace lodeline
