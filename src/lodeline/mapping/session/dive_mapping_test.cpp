#include "lodeline/mapping/session/dive_mapping.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "lodeline/mapping/session/map_merge.h"
#include "lodeline/mapping/session/relocalizer.h"
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

/// Path of the map of the dive.
std::filesystem::path circuitMap() {
  return std::filesystem::path(testing::TempDir()) / "lodeline_dive_mapping" / "circuit.db";
}

/// The first circuit. It is swum once, for all tests.
const MappedDive& firstCircuit() {
  static const MappedDive dive(circuit(1), newMap("circuit.db"), nullptr);
  return dive;
}

TEST(DiveMapping, FindsTheLoopsOfACircuitSwumTwiceAndNoFalseOne) {
  const MappedDive& dive = firstCircuit();
  EXPECT_GT(dive.summary.accepted, 20);
  for (const double error_m : dive.loop_errors_m) EXPECT_LT(error_m, 0.3) << "a false loop";
  const double map_m = positionRms(dive.in_map, dive.truth);
  RecordProperty("odometry_mm", static_cast<int>(1e3 * positionRms(dive.odometry, dive.truth)));
  RecordProperty("map_mm", static_cast<int>(1e3 * map_m));
  RecordProperty("loops", dive.summary.accepted);
  EXPECT_LT(map_m, 0.1) << "0.08 % of the path";
}

TEST(MapMerge, ASecondLapAddsFeaturesOnlyWhereTheFirstHasNone) {
  const MappedDive& dive = firstCircuit();
  const MapFile run = MapFile::open(circuitMap(), MapFile::Access::Read);
  MapFile map = MapFile::create(newMap("common.db"), {});
  const MergedDive merged = mergeDive(&map, run, {});
  std::vector<StoredKeyframe> rows;
  map.forEachKeyframe(map.dives().front().id, [&](const StoredKeyframe& row) { rows.push_back(row); });
  ASSERT_EQ(rows.size(), dive.true_poses.size());
  EXPECT_GT(merged.without_features, 20);
  std::vector<Rigid3> truth, with_features;
  for (const auto& [id, pose] : dive.true_poses) truth.push_back(pose);
  int left_out = 0;
  for (size_t k = 0; k < rows.size(); ++k) {
    if (rows[k].feature_count > 0) {
      with_features.push_back(truth[k]);
      continue;
    }
    ++left_out;
    const auto isNear = [&](const Rigid3& earlier) {
      const Rigid3 relative = earlier.inverse() * truth[k];
      return relative.translation.norm() < 0.85 && Quat::Identity().angularDistance(relative.rotation) < 0.4;
    };
    EXPECT_TRUE(std::any_of(with_features.begin(), with_features.end(), isNear)) << "keyframe " << k;
  }
  EXPECT_EQ(left_out, merged.without_features);
}

TEST(Relocalizer, FindsClipsOfASecondLapInTheMapOfTheFirst) {
  firstCircuit();
  const MapFile run = MapFile::open(circuitMap(), MapFile::Access::Read);
  MapFile map = MapFile::create(newMap("places.db"), {});
  mergeDive(&map, run, {});
  std::vector<StoredKeyframe> rows;
  map.forEachKeyframe(map.dives().front().id, [&](const StoredKeyframe& row) { rows.push_back(row); });
  std::vector<KeyframeId> ids;
  run.forEachKeyframe(run.dives().front().id,
                      [&](const StoredKeyframe& row) { ids.push_back(row.keyframe.id); });
  ASSERT_EQ(ids.size(), rows.size());
  const Relocalizer relocalizer(map);
  int clips = 0, found = 0;
  for (size_t k = 1; k < rows.size(); ++k) {
    // The map has no features of this clip.
    if (rows[k - 1].feature_count > 0 || rows[k].feature_count > 0) continue;
    ++clips;
    std::string reason;
    const std::vector<MapKeyframe> clip = {run.fullKeyframe(ids[k - 1]), run.fullKeyframe(ids[k])};
    const std::optional<PlaceInMap> place = relocalizer.find(clip, &reason);
    if (!place) continue;
    ++found;
    const Vec3 error_m = place->map_from_body.translation - rows[k].solved->map_from_body.translation;
    EXPECT_LT(error_m.norm(), 0.3) << "a wrong place, keyframe " << k;
  }
  RecordProperty("clips", clips);
  RecordProperty("found", found);
  EXPECT_GT(clips, 5);
  EXPECT_GE(found, 0.8 * clips);
}

}  // namespace
}  // namespace lodeline
