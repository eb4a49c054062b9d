#include "lodeline/mapping/session/dive_mapping.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "lodeline/mapping/session/test_mapped_dive.h"

namespace lodeline {
namespace {

/// Path of a map file that does not exist yet.
std::filesystem::path newMap(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "lodeline_dive_mapping";
  std::filesystem::create_directories(folder);
  for (const char* suffix : {"", "-wal", "-shm"}) std::filesystem::remove(folder / (name + suffix));
  return folder / name;
}

/// A circuit of 60 m swum twice, by a rig with a wrong calibration and without magnetometer.
MappedDiveOptions circuit(uint64_t seed) {
  MappedDiveOptions options;
  options.cave.shape = CaveShape::Loop;
  options.cave.seed = 7400 + seed;
  options.cave.path_length_m = 120.0;
  options.cave.laps = 2;
  options.dive_seed = 8400 + seed;
  return options;
}

TEST(DiveMapping, FindsTheLoopsOfACircuitSwumTwiceAndNoFalseOne) {
  const MappedDive dive(circuit(1), newMap("circuit.db"), nullptr);
  EXPECT_GT(dive.summary.accepted, 20);
  for (const double error_m : dive.loop_errors_m) EXPECT_LT(error_m, 0.3) << "a false loop";
  const double map_m = positionRms(dive.in_map, dive.truth);
  RecordProperty("odometry_mm", static_cast<int>(1e3 * positionRms(dive.odometry, dive.truth)));
  RecordProperty("map_mm", static_cast<int>(1e3 * map_m));
  RecordProperty("loops", dive.summary.accepted);
  EXPECT_LT(map_m, 0.1) << "0.08 % of the path";
}

}  // namespace
}  // namespace lodeline
