#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "apps/lodeline/tests/test_program.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/rig.h"
#include "lodeline/util/angles.h"

// Tests of `lodeline calibrate cameras` as a program, on rendered boards.

namespace lodeline {
namespace {

namespace fs = std::filesystem;
using test::Execution;
using test::runProgram;
using ::testing::HasSubstr;

class CalibrateCamerasTest : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return test::quoted(folder_.path() / name); }

  void simulate(const std::string& name, const std::string& options) {
    const Execution result = runProgram("simulate " + options + " --quiet -o " + file(name));
    ASSERT_EQ(result.exit_code, 0) << result.output;
  }

  Rig rigAt(const std::vector<fs::path>& files) const {
    Diagnostics diagnostics;
    return readRig(files, &diagnostics).rig;
  }

  test::TemporaryFolder folder_;
};

TEST_F(CalibrateCamerasTest, CalibratesRigAndPortUnderWater) {
  simulate("board",
           "board_in_water --seconds 7 --camera-rate-hz 4 --width 480 --effect flat_port=on "
           "--effect port_in_files=on --effect camera_delay=on --effect camera_imu_extrinsics=on");
  const Execution result = runProgram("calibrate cameras " + file("board") + " -o " + file("out"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("Verdict: "));
  for (const char* name :
       {"rig.yaml", "camchain-imucam.yaml", "report.html", "report.txt", "calibration.json"})
    EXPECT_TRUE(fs::exists(folder_.path() / "out" / name)) << name;

  const Rig rig = rigAt({folder_.path() / "out" / "rig.yaml"});
  const fs::path truth = folder_.path() / "board" / "truth" / "calibration";
  const nlohmann::json json = test::readJson(folder_.path() / "out" / "calibration.json");
  for (size_t k = 0; k < 2; ++k) {
    const Rig true_rig = rigAt(
        {truth / "cam0" / "sensor.yaml", truth / "cam1" / "sensor.yaml", truth / "imu0" / "sensor.yaml"});
    const CameraCalibration &c = rig.cameras[k], &t = true_rig.cameras[k];
    EXPECT_NEAR(c.fx_px / t.fx_px, 1.0, 1e-3);
    EXPECT_NEAR(c.cx_px, t.cx_px, 0.3);
    ASSERT_TRUE(c.port);
    EXPECT_LT(std::acos(std::min(1.0, c.port->normal_C.dot(t.port->normal_C))), 0.1 * kDegree);
    EXPECT_NEAR(c.port->distance_m, t.port->distance_m, 1e-3);
    EXPECT_LT(so3::log(c.body_from_camera.rotation * t.body_from_camera.rotation.conjugate()).norm(),
              0.1 * kDegree);
    EXPECT_LT((c.body_from_camera.translation - t.body_from_camera.translation).norm(), 2e-3);
    EXPECT_LT(c.time_offset_to_imu_s, -0.002) << "the stamps are 3 to 8 ms late";
    EXPECT_LT(json["cameras"][k]["residual_rms_px"].get<double>(), 0.1);
  }

  const Execution other =
      runProgram("calibrate cameras " + file("board") + " -o " + file("alone") +
                 " --no-imu --cameras 0 --rig " + file("out/rig.yaml") + " --keep lens,port");
  EXPECT_EQ(other.exit_code, 0) << other.output;
  EXPECT_THAT(other.output, HasSubstr("the lens was kept as stated"));
  EXPECT_TRUE(fs::exists(folder_.path() / "alone" / "camchain.yaml"));
}

TEST_F(CalibrateCamerasTest, SaysWhatItMisses) {
  simulate("dive", "demo --seconds 14 --metres 1.2 --width 96 --camera-rate-hz 1");
  const std::string command = "calibrate cameras " + file("dive") + " -o " + file("out");
  Execution result = runProgram(command);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("--board"));

  std::ofstream(folder_.path() / "board.yaml")
      << "target_type: aprilgrid\ntagCols: 5\ntagRows: 4\ntagSize: 0.05\ntagSpacing: 0.3\n";
  result = runProgram(command + " --board " + file("board.yaml"));
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.output, HasSubstr("no board found in"));
  EXPECT_THAT(result.output, HasSubstr("5 x 4 tags of the family 36h11"));
  EXPECT_FALSE(fs::exists(folder_.path() / "out"));

  std::ofstream(folder_.path() / "other.yaml") << "target_type: checkerboard\n";
  result = runProgram(command + " --board " + file("other.yaml"));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, HasSubstr("aprilgrid"));
  result = runProgram(command + " --board " + file("board.yaml") + " --camera-model fishey");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("fishey"));
}

}  // namespace
}  // namespace lodeline
