#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>

#include "lodeline/types.h"

namespace lodeline {

/// A small EuRoC recording for tests, in a temporary folder that the destructor removes. It has two cameras
/// of 16 x 12 px at 20 Hz from 1.0 to 2.0 s, an IMU at 200 Hz from 0.5 to 2.5 s and a magnetometer at 50 Hz.
/// The gyroscope's first axis reads the time in seconds. Each test damages the part that it examines.
class TestRecording {
 public:
  TestRecording();
  ~TestRecording();
  TestRecording(const TestRecording&) = delete;
  TestRecording& operator=(const TestRecording&) = delete;

  const std::filesystem::path& folder() const { return folder_; }
  /// Path below mav0.
  std::filesystem::path path(const std::string& below) const { return folder_ / "mav0" / below; }
  std::filesystem::path image(int camera, double time_s) const;

  void write(const std::string& below, const std::string& text) const;
  std::string read(const std::string& below) const;
  /// Replaces the only occurrence of a text; throws where there is none.
  void replace(const std::string& below, const std::string& from, const std::string& to) const;

 private:
  void writeImu() const;
  void writeMagnetometer() const;
  void writeCamera(int camera) const;

  std::filesystem::path folder_;
};

/// Stamps of the test recordings: `seconds` after an epoch so large that doubles lose nanoseconds.
Time testTime(double seconds);
/// The stamp as written in a CSV file.
std::string testStamp(double seconds);

}  // namespace lodeline
