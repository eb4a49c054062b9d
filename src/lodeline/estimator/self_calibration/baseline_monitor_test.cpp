#include "lodeline/estimator/self_calibration/baseline_monitor.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

class BaselineMonitorTest : public testing::Test {
 protected:
  static Rig rig() {
    Rig rig;
    rig.cameras.resize(2);
    rig.cameras[0].body_from_camera.translation = Vec3(0.3, 0.2, 0.1);
    rig.cameras[1].name = "right";
    rig.cameras[1].body_from_camera.translation = Vec3(0.4, 0.2, 0.1);
    return rig;
  }

  void add(int frames, double longer_m) {
    CameraCorrections corrections;
    corrections.extrinsics.resize(2, Eigen::Matrix<double, 6, 1>::Zero());
    corrections.extrinsics[0][3] = 0.05;  // the pose of the pair in the body does not matter here
    corrections.extrinsics[1][3] = longer_m;
    for (int i = 0; i < frames; ++i) watch_.add(Time::fromNanoseconds(7), corrections, &diagnostics_);
  }

  BaselineMonitor watch_{rig()};
  Diagnostics diagnostics_;
};

TEST_F(BaselineMonitorTest, SaysOnceWhatCameOutOtherwise) {
  add(300, -0.004);
  const auto findings = diagnostics_.ranked();
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].kind, "baseline_differs");
  EXPECT_EQ(findings[0].count, 1);
  EXPECT_NE(findings[0].first_message.find("'right'"), std::string::npos);
  EXPECT_NE(findings[0].first_message.find("96.0 mm"), std::string::npos);
  EXPECT_NE(findings[0].first_message.find("100.0 mm"), std::string::npos);
}

TEST_F(BaselineMonitorTest, KeepsQuietOfPassingAndSmallErrors) {
  for (int i = 0; i < 5; ++i) {
    add(90, 0.004);
    add(1, 0.0);
  }
  add(300, 0.0009);
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

}  // namespace
}  // namespace lodeline
