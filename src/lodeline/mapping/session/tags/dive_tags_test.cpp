#include "lodeline/mapping/session/tags/dive_tags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "lodeline/mapping/control/control_residual.h"
#include "lodeline/mapping/session/map_merge.h"
#include "lodeline/mapping/session/map_solution.h"
#include "lodeline/mapping/session/test_mapped_dive.h"

// Tests of tags on the line with the truth of the simulator: a circuit swum twice in silt, where no place is
// recognized by its look.

namespace lodeline {
namespace {

using ::testing::HasSubstr;

/// Path of a map file that does not exist yet.
std::filesystem::path newTagMap(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "lodeline_dive_tags";
  std::filesystem::create_directories(folder);
  for (const char* suffix : {"", "-wal", "-shm"}) std::filesystem::remove(folder / (name + suffix));
  return folder / name;
}

MappedDiveOptions taggedCircuit(uint64_t dive_seed, int laps, int tags) {
  MappedDiveOptions options;
  options.cave.shape = CaveShape::Loop;
  options.cave.seed = 7501;
  options.cave.laps = laps;
  options.cave.path_length_m = 45.0 * laps;
  options.dive_seed = dive_seed;
  options.recognizes_places = false;
  options.tracks = 30;  // few, so that the odometry drifts
  options.rotation_error_rad = 0.004;
  options.tags = tags;
  return options;
}

/// A dive with its map, made once for all tests that need it.
struct Dived {
  Dived(const MappedDiveOptions& options, const std::string& name)
      : file(newTagMap(name)), dive(options, file, nullptr) {}
  std::filesystem::path file;
  MappedDive dive;
};

std::map<KeyframeId, Vec3> solvedPositions(const MapFile& map, DiveId dive) {
  std::map<KeyframeId, Vec3> positions;
  map.forEachKeyframe(dive, [&](const StoredKeyframe& row) {
    positions[row.keyframe.id] = row.solved->map_from_body.translation;
  });
  return positions;
}

/// Root mean square error of the distances between keyframes of one dive and of another, each the 5th. It
/// does not depend on the frame of the map.
double distanceError(const std::map<KeyframeId, Vec3>& solved_1, const std::vector<Vec3>& true_1,
                     const std::map<KeyframeId, Vec3>& solved_2, const std::vector<Vec3>& true_2) {
  double sum = 0.0;
  int count = 0;
  size_t i = 0;
  for (const auto& [id_1, p_1] : solved_1) {
    const Vec3& t_1 = true_1.at(i++);
    size_t j = 0;
    for (const auto& [id_2, p_2] : solved_2) {
      const Vec3& t_2 = true_2.at(j++);
      if (i % 5 != 0 || j % 5 != 0) continue;
      sum += std::pow((p_1 - p_2).norm() - (t_1 - t_2).norm(), 2);
      ++count;
    }
  }
  return std::sqrt(sum / count);
}

std::vector<Vec3> trueOf(const MappedDive& dive) {
  std::vector<Vec3> positions;
  for (const auto& [id, pose] : dive.true_poses) positions.push_back(pose.translation);
  return positions;
}

/// Error within the map of one dive.
double ownError(const Dived& dived) {
  const MapFile map = MapFile::open(dived.file, MapFile::Access::Read);
  const auto solved = solvedPositions(map, map.dives().front().id);
  return distanceError(solved, trueOf(dived.dive), solved, trueOf(dived.dive));
}

std::vector<Loop> tagRows(const std::vector<Loop>& ledger, LoopStatus status) {
  std::vector<Loop> rows;
  for (const Loop& row : ledger) {
    if (row.source == kTagSource && row.status == status) rows.push_back(row);
  }
  return rows;
}

const Dived& twoLaps() {
  static const Dived dived(taggedCircuit(8501, 2, 6), "two_laps.db");
  return dived;
}
const Dived& twoLapsWithoutTags() {
  static const Dived dived(taggedCircuit(8501, 2, 0), "without.db");
  return dived;
}

TEST(DiveTags, TieTheLapsOfACircuit) {
  const double with_m = ownError(twoLaps()), without_m = ownError(twoLapsWithoutTags());
  RecordProperty("with_mm", static_cast<int>(1e3 * with_m));
  RecordProperty("without_mm", static_cast<int>(1e3 * without_m));
  EXPECT_GE(tagRows(twoLaps().dive.ledger, LoopStatus::Accepted).size(), 2u);
  EXPECT_THAT(tagRows(twoLaps().dive.ledger, LoopStatus::Refused), testing::IsEmpty());
  EXPECT_LT(with_m, 1.05 * without_m) << "odometry over 100 m is as good as a tag, and must not get worse";
}

TEST(DiveTags, AreStoredWithResidualsAsLargeAsTheirSigmas) {
  const MapFile map = MapFile::open(twoLaps().file, MapFile::Access::Read);
  EXPECT_EQ(map.controlPoints().size(), 6u);
  EXPECT_THAT(map.check(), testing::IsEmpty());
  int stored_ties = 0;
  map.forEachLoop([&](const StoredLoop& row) { stored_ties += isTagTie(row.loop) ? 1 : 0; });
  EXPECT_EQ(stored_ties, 0) << "the observations say it, and must not count twice";
  const auto residuals =
      controlResiduals(controlFactorsOf(map), [&](KeyframeId id) { return map.keyframe(id)->solved; });
  EXPECT_GT(residuals.size(), 20u);
  EXPECT_THAT(blunderTexts(residuals), testing::IsEmpty());
}

TEST(DiveTags, NameTwoTagsWithOneNumber) {
  MappedDiveOptions options = taggedCircuit(8501, 2, 6);
  options.tag_numbers = {{4, 1}};
  const Dived dived(options, "same_number.db");
  const std::vector<Loop> refused = tagRows(dived.dive.ledger, LoopStatus::Refused);
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_THAT(refused.front().reason, HasSubstr("tag 1 hangs"));
  // Each place ties its own laps.
  const MapFile map = MapFile::open(dived.file, MapFile::Access::Read);
  std::map<std::string, int> names;
  for (const ControlPoint& point : map.controlPoints()) names[point.name] = point.tag.value_or(-1);
  EXPECT_EQ(names["tag 1"], 1);
  EXPECT_EQ(names["tag 1 (2)"], 1);
  EXPECT_EQ(names.size(), 6u);
  EXPECT_LT(ownError(dived), 1.1 * ownError(twoLaps()) + 0.01);
}

/// A map of two dives, and its error between them.
struct JoinedMap {
  JoinedMap(const Dived& first, const Dived& second, const std::string& name,
            const MapMergeOptions& options = {})
      : map(MapFile::create(newTagMap(name), {})) {
    mergeDive(&map, MapFile::open(first.file, MapFile::Access::Read), {});
    merged = mergeDive(&map, MapFile::open(second.file, MapFile::Access::Read), options);
    solution = solveMap(&map, {});
    const auto solved_1 = solvedPositions(map, map.dives()[0].id),
               solved_2 = solvedPositions(map, map.dives()[1].id);
    error_m = distanceError(solved_1, trueOf(first.dive), solved_2, trueOf(second.dive));
  }
  MapFile map;
  MergedDive merged;
  MapSolution solution;
  double error_m = 0.0;
};

TEST(DiveTags, JoinDivesThatRecognizeNothingElse) {
  const Dived second(taggedCircuit(8502, 1, 6), "second.db");
  const JoinedMap joined(twoLaps(), second, "joined.db");
  EXPECT_TRUE(joined.merged.summary.is_placed);
  EXPECT_THAT(joined.solution.unconnected, testing::IsEmpty());
  EXPECT_GE(joined.merged.summary.accepted_between_dives, 2);
  EXPECT_LT(joined.error_m, 0.3);
  // Without tags, the dive lies where it is said to begin.
  const Dived untagged(taggedCircuit(8502, 1, 0), "untagged.db");
  MapMergeOptions options;
  options.mapping.start = DiveStart{Vec3(1.0, -1.0, 0.5), 3.0, 1.0};
  const JoinedMap stated(twoLaps(), untagged, "stated.db", options);
  RecordProperty("with_mm", static_cast<int>(1e3 * joined.error_m));
  RecordProperty("without_mm", static_cast<int>(1e3 * stated.error_m));
  EXPECT_LT(joined.error_m, 0.3 * stated.error_m);
  EXPECT_EQ(joined.map.controlPoints().size(), 6u);
  EXPECT_THAT(joined.map.check(), testing::IsEmpty());
}

TEST(DiveTags, NameATagThatAnotherDiveSeesElsewhere) {
  MappedDiveOptions options = taggedCircuit(8502, 1, 6);
  options.tag_numbers = {{3, 0}, {0, 3}};  // two plates were swapped
  const Dived second(options, "swapped.db");
  const JoinedMap joined(twoLaps(), second, "joined_swapped.db");
  EXPECT_TRUE(joined.merged.summary.is_placed);
  const std::vector<Loop> refused = tagRows(joined.merged.ledger, LoopStatus::Refused);
  // Each of the two plates that the dive sees is named.
  std::string reasons;
  for (const Loop& row : refused) reasons += row.reason + "; ";
  int seen = 0;
  for (const ControlPoint& point : MapFile::open(second.file, MapFile::Access::Read).controlPoints()) {
    if (point.tag != 0 && point.tag != 3) continue;
    ++seen;
    EXPECT_THAT(reasons, HasSubstr("tag " + std::to_string(*point.tag) + " hangs"));
  }
  EXPECT_GE(seen, 1);
  EXPECT_EQ(refused.size(), static_cast<size_t>(seen)) << reasons;
  EXPECT_LT(joined.error_m, 0.3) << "the swapped tags do not bend the map";
}

TEST(DiveTags, DoNotJoinDivesByOneNumber) {
  const Dived second(taggedCircuit(8503, 1, 1), "one_tag.db");
  MappedDiveOptions options = taggedCircuit(8504, 1, 1);
  const Dived third(options, "one_tag_again.db");
  const JoinedMap joined(second, third, "joined_one.db");
  EXPECT_FALSE(joined.merged.summary.is_placed);
  EXPECT_EQ(joined.solution.unconnected.size(), 1u);
  const std::vector<Loop> refused = tagRows(joined.merged.ledger, LoopStatus::Refused);
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_THAT(refused.front().reason, HasSubstr("neither a second tag"));
}

}  // namespace
}  // namespace lodeline
