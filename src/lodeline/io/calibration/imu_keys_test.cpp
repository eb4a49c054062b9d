#include "lodeline/io/calibration/imu_keys.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/euroc/test_recording.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

constexpr const char* kKalibrMatrices = R"(model: scale-misalignment
gyroscopes:
  A: [[0.001, 0, 0], [0, 0, 0], [0, 0, 0.002]]
  C_gyro_i: [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]
  M: [[1.1, 0, 0], [0.01, 0.9, 0], [0.02, 0.03, 1.05]]
accelerometers:
  M: [[1.02, 0, 0], [0.01, 0.98, 0], [0.03, -0.02, 1.01]]
time_offset: 0.003
)";

std::optional<ImuCorrection> readText(const std::string& text) {
  CalibrationMap map(YAML::Load(text), "imu.yaml", "");
  return readImuCorrection(&map);
}

std::string refusal(const std::string& text) {
  try {
    readText(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ImuKeys, KalibrsMatricesAreInverted) {
  const std::optional<ImuCorrection> correction = readText(kKalibrMatrices);
  ASSERT_TRUE(correction);
  const Vec3 w(0.3, -0.2, 0.5), f(1.0, 2.0, 9.0);
  Mat3 turn, gyro, acc, sensitivity;
  turn << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  gyro << 1.1, 0, 0, 0.01, 0.9, 0, 0.02, 0.03, 1.05;
  acc << 1.02, 0, 0, 0.01, 0.98, 0, 0.03, -0.02, 1.01;
  sensitivity << 0.001, 0, 0, 0, 0, 0, 0, 0, 0.002;
  // Kalibr's model: the accelerations that affect the gyroscope are in the gyroscope's axes.
  const ImuSample reading{testTime(1.0), gyro * (turn * w) + sensitivity * (turn * f), acc * f};
  const ImuSample sample = correction->applied(reading);
  EXPECT_TRUE(sample.angular_velocity_B.isApprox(w, 1e-12));
  EXPECT_TRUE(sample.specific_force_B.isApprox(f, 1e-12));
  EXPECT_EQ(sample.time, testTime(1.003));
}

TEST(ImuKeys, OpenVinsMatricesAreInverted) {
  const std::optional<ImuCorrection> correction = readText(R"(model: kalibr
Tw: [[1.1, 0, 0], [0.01, 0.9, 0], [0.02, 0.03, 1.05]]
R_IMUtoGYRO: [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]
Ta: [[1.02, 0, 0], [0.01, 0.98, 0], [0.03, -0.02, 1.01]]
R_IMUtoACC: [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
Tg: [[0.001, 0, 0], [0, 0, 0], [0, 0, 0.002]]
)");
  ASSERT_TRUE(correction);
  const Vec3 w(0.3, -0.2, 0.5), f(1.0, 2.0, 9.0);
  Mat3 gyro_turn, acc_turn, gyro, acc, sensitivity;
  gyro_turn << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  acc_turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  gyro << 1.1, 0, 0, 0.01, 0.9, 0, 0.02, 0.03, 1.05;
  acc << 1.02, 0, 0, 0.01, 0.98, 0, 0.03, -0.02, 1.01;
  sensitivity << 0.001, 0, 0, 0, 0, 0, 0, 0, 0.002;
  const ImuSample sample =
      correction->applied({testTime(1.0), gyro * (gyro_turn * w) + sensitivity * f, acc * (acc_turn * f)});
  EXPECT_TRUE(sample.angular_velocity_B.isApprox(w, 1e-12));
  EXPECT_TRUE(sample.specific_force_B.isApprox(f, 1e-12));
}

TEST(ImuKeys, AnIdealImuHasNoCorrection) {
  EXPECT_FALSE(readText("model: calibrated\ntime_offset: 0.0\n"));
  EXPECT_FALSE(readText("model: kalibr\nTw: [1,0,0, 0,1,0, 0,0,1]\nTg: [0,0,0, 0,0,0, 0,0,0]\n"));
}

TEST(ImuKeys, RefusesWhatCannotBe) {
  EXPECT_THAT(refusal("model: scale-misalignment\n"), HasSubstr("matrices are missing"));
  EXPECT_THAT(refusal("model: quadratic\n"), HasSubstr("known are calibrated"));
  EXPECT_THAT(refusal("gyroscopes: {M: [1,0,0, 0,0,0, 0,0,1]}\n"), HasSubstr("cannot be the scale"));
  EXPECT_THAT(refusal("gyroscopes: {M: [-1,0,0, 0,1,0, 0,0,1]}\n"), HasSubstr("cannot be the scale"));
  EXPECT_THAT(refusal("gyroscopes: {C_gyro_i: [2,0,0, 0,1,0, 0,0,1]}\n"), HasSubstr("not a rotation"));
  EXPECT_THAT(refusal("accelerometers: {N: [1,0,0, 0,1,0, 0,0,1]}\n"), HasSubstr("unknown key"));
  EXPECT_THAT(refusal("accelerometers: {M: [1,0,0, 0,1,0, 0,0,1], ry_i: [0, 0.02, 0]}\n"),
              HasSubstr("20.0 mm from the IMU's origin"));
}

TEST(ImuKeys, SourcesCorrectTheReadingsAndKeepTheStoredOnes) {
  TestRecording recording;
  recording.write("imu0/sensor.yaml",
                  recording.read("imu0/sensor.yaml") +
                      "gyroscopes: {M: [2,0,0, 0,1,0, 0,0,1]}\n"
                      "accelerometers: {M: [1,0,0, 0,1,0, 0,0,1.4], bias: [0.1, 0, 0]}\n");
  Diagnostics diagnostics;
  EurocSource source(recording.folder(), {}, &diagnostics);
  Diagnostics reported_above;
  EurocSource again(recording.folder(), {}, &reported_above);
  const std::optional<ImuSample> stored = source.nextRecordedImu();
  const std::optional<ImuSample> corrected = again.nextImu();
  ASSERT_TRUE(stored && corrected);
  const Vec3 w = stored->angular_velocity_B, f = stored->specific_force_B;
  EXPECT_TRUE(corrected->angular_velocity_B.isApprox(Vec3(w.x() / 2, w.y(), w.z()), 1e-12));
  EXPECT_TRUE(corrected->specific_force_B.isApprox(Vec3(f.x() - 0.1, f.y(), f.z() / 1.4), 1e-12));
  EXPECT_EQ(diagnostics.count("imu_correction"), 1);
}

}  // namespace
}  // namespace lodeline
