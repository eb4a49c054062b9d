#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>

#include "lodeline/util/time/time.h"

namespace lodeline {

/// A small EuRoC recording for tests, in a folder of its own that goes away with the object: two cameras of
/// 16 x 12 px at 20 Hz from 1.0 to 2.0 s, an IMU at 200 Hz from 0.5 to 2.5 s and a magnetometer at 50 Hz. The
/// gyroscope reads the time in seconds on its first axis. Tests then spoil what they are about.
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
  /// Replaces the one occurrence of a text; throws where there is none.
  void replace(const std::string& below, const std::string& from, const std::string& to) const;

 private:
  void writeImu() const;
  void writeMagnetometer() const;
  void writeCamera(int camera) const;

  std::filesystem::path folder_;
};

/// Stamps of the test recordings: an epoch of which doubles lose nanoseconds, plus so many seconds.
Time testTime(double seconds);
/// The stamp as a CSV file writes it.
std::string testStamp(double seconds);

}  // namespace lodeline
