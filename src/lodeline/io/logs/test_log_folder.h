#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/logs/open_sensor_log.h"

namespace lodeline::test {

constexpr int kRows = 40;

/// A folder for logs, and what reading one of them gives.
class SensorLogTest : public ::testing::Test {
 protected:
  SensorLogTest()
      : folder_(std::filesystem::temp_directory_path() /
                (std::string("lodeline_log_") +
                 ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~SensorLogTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }

  std::vector<LogReading> read(const std::filesystem::path& path) {
    EXPECT_TRUE(isSensorLog(path));
    const std::unique_ptr<SensorLog> log = openSensorLog(path, {}, &diagnostics_);
    sensors_ = log->sensors();
    std::vector<LogReading> readings;
    for (LogReading reading; log->next(&reading);) readings.push_back(reading);
    return readings;
  }

  std::string finding(const std::string& kind) const {
    for (const Finding& finding : diagnostics_.ranked()) {
      if (finding.kind == kind) return finding.first_message;
    }
    return "";
  }

  /// Rows `t<sep>x<sep>y<sep>z` at a rate, from `first_s` on.
  static std::string rows(const std::string& header, const std::string& row, double rate_hz,
                          double first_s = 0.0) {
    std::string text = header + "\n";
    for (int i = 0; i < kRows; ++i) text += fmt::format(fmt::runtime(row), first_s + i / rate_hz) + "\n";
    return text;
  }

  std::filesystem::path folder_;
  Diagnostics diagnostics_;
  LogSensors sensors_;
};

template <typename Get>
std::vector<LogReading> having(const std::vector<LogReading>& readings, const Get& get) {
  std::vector<LogReading> found;
  for (const LogReading& reading : readings) {
    if (get(reading)) found.push_back(reading);
  }
  return found;
}
inline bool hasRate(const LogReading& reading) { return reading.angular_velocity.has_value(); }
inline bool hasForce(const LogReading& reading) { return reading.specific_force.has_value(); }
inline bool hasField(const LogReading& reading) { return reading.field.has_value(); }

}  // namespace lodeline::test
