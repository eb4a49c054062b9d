#include "lodeline/mapping/session/dive_mapping.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "lodeline/batch/refine.h"
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

TEST(DiveMapping, ClosesTheLoopsOfACircuitSwumTwice) {
  const MappedDive dive(circuit(1), newMap("circuit.db"), nullptr);
  EXPECT_GT(dive.summary.accepted, 20);
  for (const double error_m : dive.loop_errors_m) EXPECT_LT(error_m, 0.3) << "a false loop";
  // Only the second lap can profit.
  const size_t half = dive.truth.size() * 6 / 10;
  const auto secondLap = [&](const std::vector<Rigid3>& poses) {
    return std::vector<Rigid3>(poses.begin() + static_cast<std::ptrdiff_t>(half), poses.end());
  };
  const double odometry_m = positionRms(secondLap(dive.odometry), secondLap(dive.truth));
  const double map_m = positionRms(secondLap(dive.in_map), secondLap(dive.truth));
  const Refinement without = refine(dive.rig, dive.options, dive.record);
  const Refinement with = refine(dive.rig, dive.options, dive.record, dive.closures);
  const auto posesOf = [](const Refinement& refinement) {
    std::vector<Rigid3> poses;
    for (const FrameEstimate& frame : refinement.frames) poses.push_back(frame.state.world_from_body);
    return poses;
  };
  const double without_m = positionRms(posesOf(without), dive.truth);
  const double with_m = positionRms(posesOf(with), dive.truth);
  RecordProperty("odometry_mm", static_cast<int>(1e3 * odometry_m));
  RecordProperty("map_mm", static_cast<int>(1e3 * map_m));
  RecordProperty("batch_without_mm", static_cast<int>(1e3 * without_m));
  RecordProperty("batch_with_mm", static_cast<int>(1e3 * with_m));
  RecordProperty("loops", dive.summary.accepted);
  EXPECT_LT(map_m, 0.6 * odometry_m);
  EXPECT_LT(with_m, 0.6 * without_m);
}

}  // namespace
}  // namespace lodeline
