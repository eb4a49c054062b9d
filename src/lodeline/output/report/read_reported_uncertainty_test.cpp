#include "lodeline/output/report/read_reported_uncertainty.h"

#include <gtest/gtest.h>

#include <fstream>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

namespace lodeline {
namespace {

class ClaimFiles : public testing::Test {
 protected:
  void write(const char* name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
  }

  test::TemporaryFolder folder_;
  Diagnostics diagnostics_;
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
  const ReportedUncertainty claims = readReportedUncertainty(folder_.path(), &diagnostics_);
  EXPECT_EQ(claims.basis, HeadingBasis::North);
  ASSERT_EQ(claims.poses.size(), 1u);
  EXPECT_EQ(claims.poses[0].pose.time, Time::fromSeconds(2.0));
  EXPECT_EQ(claims.poses[0].pose.world_from_body.translation, Vec3(1, 2, 3));
  EXPECT_EQ(claims.poses[0].position_sigma_m, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(claims.poses[0].rotation_sigma_rad, Vec3(0.4, 0.5, 0.7)) << "z is the heading's";
}

TEST_F(ClaimFiles, OfAnotherKindAreRefusedAndNoneIsNone) {
  EXPECT_TRUE(readReportedUncertainty(folder_.path(), &diagnostics_).poses.empty());
  write("states.csv", "#timestamp [ns],status\n1000000000,tracking\n");
  EXPECT_THROW(readReportedUncertainty(folder_.path(), &diagnostics_), InputError);
  write("states.csv", kHeader);
  EXPECT_TRUE(readReportedUncertainty(folder_.path(), &diagnostics_).poses.empty());
  write("run.json", "{");
  EXPECT_THROW(readReportedUncertainty(folder_.path(), &diagnostics_), InputError);
}

}  // namespace
}  // namespace lodeline
