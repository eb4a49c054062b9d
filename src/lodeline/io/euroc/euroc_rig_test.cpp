#include "lodeline/io/euroc/euroc_rig.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/euroc/test_recording.h"

namespace lodeline {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::ThrowsMessage;

class EurocRigTest : public testing::Test {
 protected:
  Rig read(const std::vector<int>& cameras = {}) {
    return readEurocRig(findEurocLayout(recording_.folder(), {.camera_indices = cameras}), &diagnostics_);
  }
  auto reading() {
    return [this] { read(); };
  }

  TestRecording recording_;
  Diagnostics diagnostics_;
};

TEST_F(EurocRigTest, ReadsEverySensor) {
  recording_.write("pressure0/data.csv", "#timestamp [ns],depth [m]\n1,2\n");
  recording_.write("pressure0/sensor.yaml",
                   "%YAML:1.0\n---\nT_BS: [[1, 0, 0, 0.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n"
                   "rate_hz: 2\ndepth_noise_std: 0.03\n");
  recording_.write("sonar0/data.csv", "1,2,3\n");
  recording_.write("sonar0/sensor.yaml",
                   "T_BS: !!opencv-matrix\n  rows: 4\n  cols: 4\n  dt: d\n"
                   "  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -2, 0, 0, 0, 1]\nrange_noise_std: 0.07\n");
  const Rig rig = read();
  EXPECT_EQ(rig.imu.rate_hz, 200.0);
  EXPECT_EQ(rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz, 1.7e-4);
  EXPECT_EQ(rig.imu.noise.accelerometer_random_walk_m_per_s3_sqrtHz, 3e-3);
  ASSERT_EQ(rig.cameras.size(), 2u);
  EXPECT_EQ(rig.cameras[1].name, "cam1");
  EXPECT_EQ(rig.cameras[0].width_px, 16);
  EXPECT_EQ(rig.cameras[0].height_px, 12);
  EXPECT_EQ(rig.cameras[0].fy_px, 21.0);
  EXPECT_EQ(rig.cameras[0].model, "radial-tangential");
  EXPECT_THAT(rig.cameras[0].distortion, ElementsAre(-0.1, 0.01, 1e-4, 2e-4));
  ASSERT_TRUE(rig.magnetometer.has_value());
  EXPECT_EQ(rig.magnetometer->noise_density_T_per_sqrtHz, 1e-8);
  ASSERT_TRUE(rig.pressure.has_value());
  EXPECT_EQ(rig.pressure->body_from_pressure.translation, Vec3(0.5, 0, 0));
  EXPECT_EQ(rig.pressure->depth_noise_std_m, 0.03);
  ASSERT_TRUE(rig.sonar.has_value());
  EXPECT_EQ(rig.sonar->body_from_sonar.translation, Vec3(0, 0, -2));
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(EurocRigTest, SelectsCamerasInTheOrderAskedFor) {
  const Rig rig = read({1});
  ASSERT_EQ(rig.cameras.size(), 1u);
  EXPECT_EQ(rig.cameras[0].name, "cam1");
  EXPECT_THAT(
      [&] {
        read({0, 3});
      },
      ThrowsMessage<InputError>(AllOf(HasSubstr("camera 3"), HasSubstr("[0, 1]"))));
}

TEST_F(EurocRigTest, AcceptsMav0ItselfAndRefusesOtherFolders) {
  EXPECT_EQ(findEurocLayout(recording_.path(""), {}).camera_indices, (std::vector<int>{0, 1}));
  EXPECT_THAT([] { findEurocLayout("/no/such/place", {}); },
              ThrowsMessage<InputError>(HasSubstr("no such folder")));
  EXPECT_THAT([&] { findEurocLayout(recording_.path("imu0"), {}); },
              ThrowsMessage<InputError>(HasSubstr("EuRoC")));
}

TEST_F(EurocRigTest, OpensReadingsWithoutCamerasForToolsThatNeedNone) {
  for (const char* camera : {"cam0", "cam1"}) std::filesystem::remove_all(recording_.path(camera));
  EXPECT_THAT(reading(), ThrowsMessage<InputError>(AllOf(HasSubstr("cam0/data.csv"), HasSubstr("images"))));
  EurocOptions options;
  options.with_cameras = false;
  EurocSource both(recording_.folder(), options, &diagnostics_);
  EXPECT_TRUE(both.rig().cameras.empty());
  EXPECT_TRUE(both.nextImu() && both.nextMagnetometer());

  std::filesystem::remove_all(recording_.path("imu0"));
  const auto opening = [&] { EurocSource(recording_.folder(), options, &diagnostics_); };
  EXPECT_THAT(opening, ThrowsMessage<InputError>(HasSubstr("imu0/data.csv: missing")));
  options.needs_imu = false;
  EurocSource magnetometer_alone(recording_.path(""), options, &diagnostics_);
  EXPECT_FALSE(magnetometer_alone.nextImu());
  EXPECT_TRUE(magnetometer_alone.nextMagnetometer());

  std::filesystem::rename(recording_.path("mag0/data.csv"), recording_.path("mag0/lost.csv"));
  EXPECT_THAT(opening, ThrowsMessage<InputError>(HasSubstr("neither imu0/data.csv nor mag0/data.csv")));
}

TEST_F(EurocRigTest, CamerasCanBeLeftOut) {
  recording_.write("cam0/sensor.yaml", "spoilt");
  EurocOptions options;
  options.with_cameras = false;
  EXPECT_TRUE(EurocSource(recording_.folder(), options, &diagnostics_).rig().cameras.empty());
}

TEST_F(EurocRigTest, BodyBecomesTheImuFrame) {
  // EuRoC's body is 1 m along x from the IMU, which is rotated by 90 degrees about z.
  recording_.replace("imu0/sensor.yaml", "[1, 0, 0, 0, 0, 1, 0, 0,", "[0, -1, 0, 1, 1, 0, 0, 0,");
  recording_.replace("mag0/sensor.yaml", "[1, 0, 0, 0, 0, 1, 0, 0,", "[1, 0, 0, 3, 0, 1, 0, 0,");
  const Rig rig = read();
  EXPECT_TRUE(rig.cameras[0].body_from_camera.translation.isApprox(Vec3(0, 1, 0), 1e-12));
  EXPECT_TRUE((rig.cameras[0].body_from_camera.rotation * Vec3(1, 0, 0)).isApprox(Vec3(0, -1, 0), 1e-12));
  EXPECT_TRUE(rig.magnetometer->body_from_magnetometer.translation.isApprox(Vec3(0, -2, 0), 1e-12));
}

TEST_F(EurocRigTest, AbsentCalibrationNamesTheFile) {
  std::filesystem::remove(recording_.path("cam1/sensor.yaml"));
  EXPECT_THAT(reading(), ThrowsMessage<InputError>(HasSubstr("cam1/sensor.yaml: calibration file missing")));
}

TEST_F(EurocRigTest, IncompleteCalibrationNamesFileAndKey) {
  recording_.replace("cam0/sensor.yaml", "intrinsics: [20, 21, 8, 6]\n", "");
  EXPECT_THAT(reading(),
              ThrowsMessage<InputError>(HasSubstr("cam0/sensor.yaml: key 'intrinsics' is missing")));
}

TEST_F(EurocRigTest, IncompleteImuNoiseNamesFileAndKey) {
  recording_.replace("imu0/sensor.yaml", "gyroscope_noise_density: 1.7e-4\n", "");
  EXPECT_THAT(reading(), ThrowsMessage<InputError>(HasSubstr("key 'gyroscope_noise_density' is missing")));
}

struct Spoilt {
  const char* from;
  const char* to;
  const char* complaint;
};

class SpoiltCamera : public EurocRigTest, public testing::WithParamInterface<Spoilt> {};

TEST_P(SpoiltCamera, IsRefusedWithTheReason) {
  recording_.replace("cam0/sensor.yaml", GetParam().from, GetParam().to);
  EXPECT_THAT(reading(), ThrowsMessage<InputError>(
                             AllOf(HasSubstr("cam0/sensor.yaml"), HasSubstr(GetParam().complaint))));
}

INSTANTIATE_TEST_SUITE_P(
    Keys, SpoiltCamera,
    testing::Values(Spoilt{"pinhole", "mirror", "camera_model 'mirror'; supported are"},
                    Spoilt{"pinhole", "omni", "must be 5 finite numbers (xi, fx, fy, cx, cy in px)"},
                    Spoilt{"pinhole", "ds", "'radial-tangential' and camera_model 'ds'"},
                    Spoilt{"radial-tangential", "fov", "fov needs 1 finite ones"},
                    Spoilt{"radial-tangential", "cubic", "'cubic'"},
                    Spoilt{"radial-tangential", "[1]", "not a word"},
                    Spoilt{"[-0.1, 0.01, 1e-4, 2e-4]", "[1, 2, 3]", "4, 5 or 8"},
                    Spoilt{"[16, 12]", "[16]", "must be 2 finite numbers"},
                    Spoilt{"[16, 12]", "[16, -12]", "positive"},
                    Spoilt{"[16, 12]", "[16, x]", "list of numbers"},
                    Spoilt{"[20, 21, 8, 6]", "[20, .nan, 8, 6]", "4 finite numbers"},
                    Spoilt{"[20, 21, 8, 6]", "[0, 21, 8, 6]", "focal lengths"},
                    Spoilt{"rate_hz: 20", "rate_hz: fast", "not a number"},
                    Spoilt{"rate_hz: 20", "rate_hz: [", "not valid YAML"},
                    Spoilt{"rate_hz: 20", "mask: none.png", "does not exist"},
                    Spoilt{"0, 0, 0, 1]", "0, 0, 0]", "needs 16"},
                    Spoilt{"data: [1, 0, 0, 0,", "data: [2, 0, 0, 0,", "not a rotation"}));

TEST_F(EurocRigTest, UnknownKeyIsOnlyANotice) {
  recording_.write("imu0/sensor.yaml", recording_.read("imu0/sensor.yaml") + "colour: blue\n");
  read();
  ASSERT_EQ(diagnostics_.ranked().size(), 1u);
  EXPECT_EQ(diagnostics_.ranked()[0].severity, Severity::Notice);
  EXPECT_THAT(diagnostics_.ranked()[0].first_message, HasSubstr("imu0/sensor.yaml: key 'colour'"));
}

TEST_F(EurocRigTest, FindsTheMaskBesideTheCalibration) {
  std::filesystem::copy_file(recording_.image(0, 1.0), recording_.path("cam0/mask.png"));
  recording_.write("cam0/sensor.yaml", recording_.read("cam0/sensor.yaml") + "mask: mask.png\n");
  EXPECT_THAT(read().cameras[0].mask_file, EndsWith("mav0/cam0/mask.png"));
}

TEST_F(EurocRigTest, EmptyCsvOfANeededSensorIsAnError) {
  recording_.write("imu0/data.csv", "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n");
  EXPECT_THAT(reading(), ThrowsMessage<InputError>(HasSubstr("imu0/data.csv: holds no usable row")));
}

TEST_F(EurocRigTest, UnusableRowsAreExplained) {
  recording_.write("imu0/data.csv", "1,2,3\n2,2,3\n");
  EXPECT_THAT(reading(),
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("imu0/data.csv:1: 3 columns where 7 are due"), HasSubstr("inertial"))));
}

TEST_F(EurocRigTest, EmptyCameraListIsAnError) {
  recording_.write("cam1/data.csv", "");
  EXPECT_THAT(reading(), ThrowsMessage<InputError>(HasSubstr("cam1/data.csv: holds no usable row")));
}

TEST_F(EurocRigTest, EmptyCsvOfAnOptionalSensorLeavesItOut) {
  recording_.write("mag0/data.csv", "");
  EXPECT_FALSE(read().magnetometer.has_value());
  EXPECT_EQ(diagnostics_.count("sensor_empty"), 1);
}

TEST_F(EurocRigTest, MissingImuIsAnError) {
  std::filesystem::remove_all(recording_.path("imu0"));
  EXPECT_THAT(reading(), ThrowsMessage<InputError>(HasSubstr("imu0/data.csv: missing")));
}

TEST_F(EurocRigTest, MeasuresRatesThatAreMissingOrWrong) {
  recording_.replace("imu0/sensor.yaml", "rate_hz: 200\n", "");
  recording_.replace("mag0/sensor.yaml", "rate_hz: 50", "rate_hz: 5");
  const Rig rig = read();
  EXPECT_NEAR(rig.imu.rate_hz, 200.0, 1e-6);
  EXPECT_NEAR(rig.magnetometer->rate_hz, 50.0, 1e-6);
  EXPECT_EQ(diagnostics_.count("rate"), 1);
}

TEST_F(EurocRigTest, RefusesIntrinsicsThatCannotBe) {
  const std::string good = "resolution: [16, 12]\ncamera_model: pinhole\nintrinsics: [20, 21, 8, 6]";
  const auto intrinsics = [](const char* numbers) {
    return fmt::format("resolution: [752, 480]\ncamera_model: pinhole\nintrinsics: [{}]", numbers);
  };
  recording_.replace("cam0/sensor.yaml", good, intrinsics("458.6, 457.3, 367.2, 248.4"));
  EurocSource(recording_.folder(), {}, &diagnostics_);
  const auto refusal = [&](const char* before, const char* numbers, const char* words) {
    recording_.replace("cam0/sensor.yaml", intrinsics(before), intrinsics(numbers));
    EXPECT_THAT([&] { EurocSource(recording_.folder(), {}, &diagnostics_); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("cam0/sensor.yaml"), HasSubstr(words))))
        << numbers;
  };
  refusal("458.6, 457.3, 367.2, 248.4", "0.6099, 0.9528, 0.4883, 0.5175", "shares of the image's size");
  refusal("0.6099, 0.9528, 0.4883, 0.5175", "45.8, 45.7, 367.2, 248.4", "focal length");
  refusal("45.8, 45.7, 367.2, 248.4", "458654, 457296, 367.2, 248.4", "focal length");
  refusal("458654, 457296, 367.2, 248.4", "458.6, 457.3, 1367.2, 248.4", "principal point");
  refusal("458.6, 457.3, 1367.2, 248.4", "458.6, 367.2, 457.3, 948.4", "principal point");
}

TEST_F(EurocRigTest, RefusesADistortionThatLeavesLittleOfTheImage) {
  recording_.replace("cam0/sensor.yaml", "[-0.1, 0.01, 1e-4, 2e-4]", "[-28, 7, 1e-4, 2e-4]");
  EXPECT_THAT([&] { EurocSource(recording_.folder(), {}, &diagnostics_); },
              ThrowsMessage<InputError>(HasSubstr("viewing ray")));
}

}  // namespace
}  // namespace lodeline
