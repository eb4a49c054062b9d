#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/calibration/rig_text.h"
#include "lodeline/io/euroc/test_recording.h"

namespace lodeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kImuSection =
    "imu0:\n  gyroscope_noise_density: 1.0e-4\n  gyroscope_random_walk: 1.0e-5\n"
    "  accelerometer_noise_density: 1.0e-3\n  accelerometer_random_walk: 1.0e-4\n";
constexpr const char* kDvlSection =
    "dvl0:\n  T_BS: [1,0,0,0.1, 0,-1,0,0.2, 0,0,-1,0.3, 0,0,0,1]\n  velocity_noise_std: 0.02\n";

class RobotCalibrationTest : public testing::Test {
 protected:
  RigFile read(const std::string& text) {
    place_.write("rig.yaml", kImuSection + text);
    return readRigFiles({place_.path("rig.yaml")}, &diagnostics_);
  }
  std::string refusal(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }

  TestRecording place_;
  Diagnostics diagnostics_;
};

TEST_F(RobotCalibrationTest, ReadsBeamsByTheirAngles) {
  const RigFile file =
      read(std::string(kDvlSection) + "  beams: {angle_deg: 22.5, azimuths_deg: [45, 135, 225, 315]}\n");
  const std::vector<Vec3> expected = DvlCalibration().beams_D;
  ASSERT_EQ(file.rig.dvl->beams_D.size(), 4u);
  for (size_t i = 0; i < 4; ++i) EXPECT_LT((file.rig.dvl->beams_D[i] - expected[i]).norm(), 1e-15) << i;
  EXPECT_EQ(file.rig.dvl->body_from_dvl.translation, Vec3(0.1, 0.2, 0.3));
}

TEST_F(RobotCalibrationTest, ASectionIsTheSameAfterWriting) {
  const RigFile file =
      read(std::string(kDvlSection) +
           "  topic: /dvl/data\n  range_noise_std: 0.04\n  beams: [[0.6, 0, 0.8], [-0.3, 0.52, 0.8], [-0.3, "
           "-0.52, 0.8]]\n"
           "  scale_sigma: 0\n  misalignment_sigma: 0.05\n  timeshift: -0.125\n  rate_hz: 8\n"
           "altimeter0:\n  T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0.5, 0,0,0,1]\n  range_noise_std: 0.03\n  "
           "max_range: 40\n"
           "current0:\n  topic: /currents\n  channels:\n    thruster 1: {field_T_per_A: [1.2e-07, -3.0e-08, "
           "4.0e-08]}\n"
           "    lamp: {field_T_per_A: [0, 0, 2.0e-08]}\n  field_sigma_T_per_A: 5.0e-09\n  timeshift: 0.25\n");
  const RigFile again = read(rigText(file).substr(rigText(file).find("altimeter0:")));
  const DvlCalibration &before = *file.rig.dvl, &after = again.rig.dvl.value();
  ASSERT_EQ(after.beams_D.size(), 3u);
  for (size_t i = 0; i < 3; ++i) EXPECT_LT((before.beams_D[i] - after.beams_D[i]).norm(), 1e-15) << i;
  EXPECT_EQ(after.velocity_noise_std_m_per_s, 0.02);
  EXPECT_EQ(after.range_noise_std_m, 0.04);
  EXPECT_EQ(after.scale_sigma, 0.0);
  EXPECT_EQ(after.misalignment_sigma_rad, 0.05);
  EXPECT_EQ(after.time_offset_to_imu_s, -0.125);
  EXPECT_EQ(after.rate_hz, 8.0);
  EXPECT_EQ(again.topics.at("dvl0"), "/dvl/data");
  EXPECT_EQ(again.rig.altimeter->max_range_m, 40.0);
  EXPECT_EQ(again.rig.altimeter->body_from_sonar.translation, Vec3(0.0, 0.0, 0.5));
  const CurrentCalibration& currents = again.rig.currents.value();
  EXPECT_THAT(currents.channels, ElementsAre("thruster 1", "lamp"));
  EXPECT_THAT(currents.fields_T_per_A, ElementsAre(Vec3(1.2e-7, -3e-8, 4e-8), Vec3(0.0, 0.0, 2e-8)));
  EXPECT_EQ(currents.field_sigma_T_per_A, 5e-9);
  EXPECT_EQ(currents.time_offset_to_imu_s, 0.25);
  const RigFile names = read("current0:\n  channels: [b, \"1\", a]\n");
  EXPECT_THAT(read(rigText(names).substr(rigText(names).find("current0:"))).rig.currents->channels,
              ElementsAre("b", "1", "a"));
}

TEST_F(RobotCalibrationTest, NamesWhatIsWrong) {
  const auto dvl = [&](const std::string& keys) { return refusal(std::string(kDvlSection) + keys); };
  EXPECT_THAT(dvl("  beams: {angle_deg: 120, azimuths_deg: [0, 120, 240]}\n"), HasSubstr("between 0 and 90"));
  EXPECT_THAT(dvl("  beams: {angle_deg: 20, azimuths_deg: [0, 180]}\n"), HasSubstr("describes 2 beams"));
  EXPECT_THAT(dvl("  beams: {angle_deg: 20, azimuth_deg: [0, 120, 240]}\n"), HasSubstr("azimuths_deg"));
  EXPECT_THAT(dvl("  beams: [[1, 0, 1], [0, 1, 0], [0, 0, 1]]\n"), HasSubstr("unit vector"));
  EXPECT_THAT(dvl("  beams: [[1, 0], [0, 1]]\n"), HasSubstr("4 numbers"));
  EXPECT_THAT(dvl("  scale_sigma: -0.1\n"), HasSubstr("must not be negative"));
  EXPECT_THAT(dvl("  scale_sigm: 0.1\n"), HasSubstr("did you mean 'scale_sigma'"));
  EXPECT_THAT(refusal("dvl0:\n  T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n"),
              HasSubstr("velocity_noise_std"));
  EXPECT_THAT(refusal("current0:\n  channels: {a: {field_T_per_A: [0, 0, 1e-8]}, b: {}}\n"),
              HasSubstr("1 of 2 channels"));
  EXPECT_THAT(refusal("current0:\n  channels: {a: {field: [0, 0, 1e-8]}}\n"), HasSubstr("unknown key"));
}

}  // namespace
}  // namespace lodeline
