#include "lodeline/io/euroc/folder_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/test_euroc_rig.h"
#include "lodeline/io/euroc/test_recording.h"

namespace lodeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class FolderCalibrationTest : public testing::Test {
 protected:
  Rig read(const std::vector<std::filesystem::path>& rig_files = {}) {
    EurocOptions options;
    options.rig_files = rig_files;
    return readEurocRig(findEurocLayout(recording_.folder(), options), &diagnostics_);
  }
  std::string refusal() {
    try {
      read();
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  void removeOwnFiles() {
    for (const char* file : {"cam0/sensor.yaml", "cam1/sensor.yaml", "imu0/sensor.yaml"}) {
      std::filesystem::remove(recording_.path(file));
    }
  }
  static void expectEuroc(const Rig& rig) {
    ASSERT_EQ(rig.cameras.size(), 2u);
    EXPECT_EQ(rig.cameras[1].fx_px, 457.587);
    EXPECT_LT((rig.cameras[1].body_from_camera.translation -
               Vec3(-0.0198435579556, 0.0453689425024, 0.00786212447038))
                  .norm(),
              1e-9);
    EXPECT_EQ(rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz, 1.6968e-4);
    EXPECT_NEAR(rig.cameras[0].rate_hz, 20.0, 1e-6) << "measured";
  }

  TestRecording recording_;
  Diagnostics diagnostics_;
  const std::string chain_ = test::eurocChain("T_imu_cam", test::kLeftPose, "T_imu_cam", test::kRightPose);
};

TEST_F(FolderCalibrationTest, FindsOpenVinsFilesByTheirNames) {
  removeOwnFiles();
  recording_.write("../kalibr_imucam_chain.yaml", "%YAML:1.0\n\n" + chain_);
  recording_.write("../kalibr_imu_chain.yaml",
                   std::string("%YAML:1.0\n\nimu0:\n  rostopic: /imu0\n") +
                       std::string(test::kEurocImu).substr(6).replace(2, 7, "update_rate") +
                       "  model: \"kalibr\"\n  Tw: [1,0,0, 0,1,0, 0,0,1]\n");
  expectEuroc(read());
  EXPECT_EQ(diagnostics_.ranked().size(), 0u);
}

TEST_F(FolderCalibrationTest, FindsOtherFilesByTheirContent) {
  removeOwnFiles();
  recording_.write("../dso/camchain.yaml", chain_);
  recording_.write("../dso/imu_config.yaml", test::kKalibrImu);
  recording_.write("../dso/notes.yaml", "a: 1\n");
  expectEuroc(read());
  EXPECT_EQ(diagnostics_.count("calibration_found"), 2);
  recording_.write("../orb.yaml", test::eurocOrbSlam());
  EXPECT_THAT(refusal(), AllOf(HasSubstr("could both be the calibration of cam0, cam1"), HasSubstr("--rig")));
}

TEST_F(FolderCalibrationTest, TakesOneFileForAll) {
  removeOwnFiles();
  recording_.write("../settings/orb.yaml", test::eurocOrbSlam());
  expectEuroc(read());
}

TEST_F(FolderCalibrationTest, RigFilesGoBeforeWhatLiesThere) {
  recording_.write("../camchain-imucam.yaml", "not: a camchain\n");
  recording_.write("../elsewhere.yaml", test::eurocRig());
  expectEuroc(read({recording_.path("../elsewhere.yaml")}));
  EXPECT_TRUE(read({recording_.path("../elsewhere.yaml")}).magnetometer) << "from its own sensor.yaml";
}

TEST_F(FolderCalibrationTest, SaysWhatToGive) {
  removeOwnFiles();
  recording_.write("../dso/notes.yaml", "a: 1\n");
  EXPECT_THAT(refusal(), AllOf(HasSubstr("cam0/sensor.yaml: calibration file missing"), HasSubstr("--rig"),
                               HasSubstr("dso/notes.yaml")));
}

TEST_F(FolderCalibrationTest, SensorsOfEurocsBodyAreMovedWhereKalibrDescribesTheImu) {
  recording_.replace("imu0/sensor.yaml", "[1, 0, 0, 0, 0, 1, 0, 0,", "[1, 0, 0, 0.5, 0, 1, 0, 0,");
  recording_.write("../imu.yaml", test::kKalibrImu);
  const Rig rig = read();
  EXPECT_TRUE(rig.magnetometer->body_from_magnetometer.translation.isApprox(Vec3(-0.5, 0, 0), 1e-12));
}

TEST_F(FolderCalibrationTest, KalibrsOtherImuFrameMovesTheCameras) {
  recording_.write("../camchain-imucam.yaml", chain_);
  recording_.write("../imu.yaml",
                   std::string(test::kKalibrImu) + "T_i_b: [1,0,0,0.2, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n");
  const Rig rig = read();
  EXPECT_NEAR(rig.cameras[0].body_from_camera.translation.x(), 0.2 - 0.0216401454975, 1e-12);
}

}  // namespace
}  // namespace lodeline
