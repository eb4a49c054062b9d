#pragma once

#include <filesystem>

namespace lodeline::test {

struct TestRun {
  int frames = 200;
  double rate_hz = 15.0;
  int landmarks_per_frame = 5;
  int pictures = 6;
  int picture_width_px = 64;
};

/// What `lodeline run` would leave in a folder for a swim along a spiral, written by the same writers: every
/// 50th frame carried inertially, a magnetometer whose gate rejects every 20th, one warning that holds
/// `</script>`.
void writeTestRun(const std::filesystem::path& folder, const TestRun& run = {});

/// The same swim as a reference of 10 poses a second, 0.1 m further up, in the layout of TUM.
void writeTestReference(const std::filesystem::path& file, const TestRun& run = {});

}  // namespace lodeline::test
