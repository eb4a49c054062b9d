#pragma once

#include <filesystem>

namespace lodeline::test {

struct TestRun {
  int frames = 200;
  double rate_hz = 15.0;
  int landmarks_per_frame = 5;
  int pictures = 6;
  int picture_width_px = 64;
  bool map = true;                ///< with loops.csv, keyframes_map.tum and control.csv
  const char* old_dive = "dive";  ///< of the second loop
};

/// Writes an output folder as `lodeline run` would for a swim along a spiral, with the same writers: every
/// 50th frame is inertial, the gate of the magnetometer rejects every 20th, and one warning contains
/// `</script>`.
void writeTestRun(const std::filesystem::path& folder, const TestRun& run = {});

/// Writes the same swim as a reference with 10 poses per second, 0.1 m higher, in the TUM layout.
void writeTestReference(const std::filesystem::path& file, const TestRun& run = {});

}  // namespace lodeline::test
