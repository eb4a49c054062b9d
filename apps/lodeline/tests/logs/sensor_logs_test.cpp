#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "apps/lodeline/tests/test_program.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/io/logs/test_logs.h"
#include "lodeline/magnetometer/calibration/calibration_file.h"

// One turning of a rig in several logs: every command must give the same figures from each.

namespace lodeline {
namespace {

using test::Execution;
using test::raws;
using test::runProgram;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int kReadings = 3000;
constexpr double kRate_hz = 50.0;
const Vec3 kHardIron_T(12e-6, -7e-6, 15e-6);

/// Readings of one time; the rig turns about two axes.
struct Row {
  uint64_t time_us = 0;
  Vec3 rate, force, field_T;
};

std::vector<Row> turning() {
  std::vector<Row> rows;
  Quat world_from_body = Quat::Identity();
  const Vec3 field_W(0.0, 24e-6, -38e-6), up_W(0.0, 0.0, 9.80665);
  for (int i = 0; i < kReadings; ++i) {
    Row row;
    row.time_us = 1'000'000 + static_cast<uint64_t>(std::lround(i * 1e6 / kRate_hz));
    row.rate = Vec3(1.1 * std::sin(0.013 * i), 0.9 * std::cos(0.0079 * i), 0.7);
    // Noise without a generator: irrational steps.
    const auto noise = [&](double scale) {
      return Vec3(scale * std::sin(12.9898 * i), scale * std::sin(78.233 * i), scale * std::sin(37.719 * i));
    };
    row.force = world_from_body.conjugate() * up_W + noise(0.02);
    row.field_T = world_from_body.conjugate() * field_W + kHardIron_T + noise(0.1e-6);
    rows.push_back(row);
    rows.back().rate += noise(0.002);
    world_from_body = (world_from_body * so3::exp(row.rate / kRate_hz)).normalized();
  }
  return rows;
}

std::string ulog(const std::vector<Row>& rows) {
  test::ULogBytes log;
  log.flags(0)
      .format("sensor_combined:uint64_t timestamp;float[3] gyro_rad;float[3] accelerometer_m_s2;")
      .format("sensor_mag:uint64_t timestamp;float x;float y;float z;")
      .subscribe(0, "sensor_combined")
      .subscribe(1, "sensor_mag");
  const auto floats = [](const Vec3& v) {
    return raws<float, float, float>(static_cast<float>(v.x()), static_cast<float>(v.y()),
                                     static_cast<float>(v.z()));
  };
  for (const Row& row : rows) {
    log.data(0, test::raw(row.time_us) + floats(row.rate) + floats(row.force));
    log.data(1, test::raw(row.time_us) + floats(1e4 * row.field_T));
  }
  return log.bytes();
}

std::string dataFlash(const std::vector<Row>& rows) {
  test::DataFlashBytes log;
  log.units();
  log.format(20, 3 + 8 + 1 + 24, "IMU", "QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ");
  log.format(21, 3 + 8 + 1 + 12, "MAG", "QBfff", "TimeUS,I,MagX,MagY,MagZ");
  log.unitsOf(20, "s#EEEooo", "F-000000").unitsOf(21, "s#GGG", "F-CCC");
  const auto floats = [](const Vec3& v) {
    return raws<float, float, float>(static_cast<float>(v.x()), static_cast<float>(v.y()),
                                     static_cast<float>(v.z()));
  };
  for (const Row& row : rows) {
    log.message(20, raws<uint64_t, uint8_t>(row.time_us, 0) + floats(row.rate) + floats(row.force));
    log.message(21, raws<uint64_t, uint8_t>(row.time_us, 0) + floats(1e7 * row.field_T));
  }
  return log.bytes();
}

std::string phyphoxZip(const std::vector<Row>& rows) {
  const auto table = [&](const char* name, const char* unit, const auto& of) {
    std::string text =
        fmt::format("\"Time (s)\",\"{0} x ({1})\",\"{0} y ({1})\",\"{0} z ({1})\"\n", name, unit);
    for (const Row& row : rows) {
      const Vec3 v = of(row);
      text += fmt::format("{:.6E},{:.9E},{:.9E},{:.9E}\n", 1e-6 * static_cast<double>(row.time_us), v.x(),
                          v.y(), v.z());
    }
    return text;
  };
  test::ZipBytes zip;
  zip.add("Gyroscope.csv", table("Gyroscope", "rad/s", [](const Row& row) { return row.rate; }));
  zip.add("Accelerometer.csv", table("Acceleration", "m/s^2", [](const Row& row) { return row.force; }));
  zip.add("Magnetometer.csv",
          table("Magnetic field", "\u00b5T", [](const Row& row) { return Vec3(1e6 * row.field_T); }));
  return zip.bytes();
}

class SensorLogsTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    const std::vector<Row> rows = turning();
    folder_->write("px4.ulg", ulog(rows));
    folder_->write("ardupilot.BIN", dataFlash(rows));
    folder_->write("phyphox.zip", phyphoxZip(rows));
  }
  static void TearDownTestSuite() { delete folder_; }
  static std::string file(const std::string& name) { return test::quoted(folder_->path() / name); }

  static test::TemporaryFolder* folder_;
  static constexpr std::array kLogs = {"px4.ulg", "ardupilot.BIN", "phyphox.zip"};
};
test::TemporaryFolder* SensorLogsTest::folder_ = nullptr;

TEST_F(SensorLogsTest, CalibrateTheMagnetometer) {
  for (const char* log : kLogs) {
    const Execution result = runProgram("calibrate magnetometer " + file(log) + " -o " + file("mag.yaml"));
    ASSERT_EQ(result.exit_code, 0) << log << result.output;
    EXPECT_THAT(result.output, AllOf(HasSubstr("magnetometer from"), HasSubstr(" in "))) << log;
    const MagnetometerFit fit = readCalibrationFile(folder_->path() / "mag.yaml");
    EXPECT_NEAR((fit.hard_iron - kHardIron_T).norm(), 0.0, 0.05e-6) << log;
    EXPECT_EQ(runProgram("calibrate magnetometer " + file(log) + " --unit uT").exit_code, 2) << log;
  }
}

TEST_F(SensorLogsTest, GiveAttitudeAndInspectionButNoNoiseWhileTurning) {
  for (const char* log : kLogs) {
    // The sensor rotates during the whole log, so its noise cannot be measured.
    const Execution allan = runProgram("allan " + file(log) + " --json " + file("allan.json"));
    EXPECT_EQ(allan.exit_code, 1) << log << allan.output;
    EXPECT_THAT(allan.output, HasSubstr("gyroscope: not still: moved in 100 %")) << log;
    const Execution attitude = runProgram("attitude " + file(log) + " -o " + file("attitude"));
    ASSERT_EQ(attitude.exit_code, 0) << log << attitude.output;
    const Execution inspect = runProgram("inspect " + file(log));
    EXPECT_EQ(inspect.exit_code, 0) << log << inspect.output;
    EXPECT_THAT(inspect.output, HasSubstr("gyroscope from")) << log;
  }
}

TEST_F(SensorLogsTest, AreRefusedWhereImagesAreNeeded) {
  for (const char* log : kLogs) {
    const Execution run = runProgram("run " + file(log) + " -o " + file("run"));
    EXPECT_EQ(run.exit_code, 1) << log << run.output;
  }
  EXPECT_THAT(runProgram("run " + file("px4.ulg") + " -o " + file("run")).output,
              HasSubstr("holds no images"));
}

}  // namespace
}  // namespace lodeline
