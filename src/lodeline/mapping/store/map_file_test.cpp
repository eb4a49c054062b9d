#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <limits>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/mapping/store/map_change.h"
#include "lodeline/mapping/store/sqlite/database.h"
#include "lodeline/mapping/store/test_map.h"

// Tests of what a map file keeps.

namespace lodeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class MapFileTest : public ::testing::Test {
 protected:
  std::filesystem::path path(const char* name = "cave.db") const { return folder_.path() / name; }

  /// Adds a dive of so many keyframes with edges between neighbours; returns its number.
  DiveId addDive(MapFile* map, const std::string& name, int keyframes, int features = 20) {
    MapChange change = map->change();
    const DiveId dive = change.addDive(test::namedDive(name));
    KeyframeId last = -1;
    for (int i = 0; i < keyframes; ++i) {
      const KeyframeId id = change.addKeyframe(test::passageKeyframe(dive, i, features, &random_));
      if (last >= 0)
        change.addEdge({last, id, Rigid3(Quat::Identity(), Vec3(0.33, 0, 0)), 1e-4 * Mat6::Identity()});
      last = id;
    }
    change.commit();
    return dive;
  }

  test::TemporaryFolder folder_;
  std::mt19937 random_{1};
};

std::string errorOf(const std::function<void()>& run) {
  try {
    run();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::vector<std::string> kindsOf(const std::vector<MapFault>& faults) {
  std::vector<std::string> kinds;
  for (const MapFault& fault : faults) kinds.push_back(fault.kind);
  return kinds;
}

TEST_F(MapFileTest, KeepsDescriptionAndDives) {
  MapDescription description;
  description.site = GeodeticPosition{29.83, -82.6, 10.123456789};
  description.field_reference = "WMM2025 2026-11-28";
  MapDive dive = test::namedDive("dive 1");
  {
    MapFile map = MapFile::create(path(), description);
    MapChange change = map.change();
    dive.id = change.addDive(dive);
    change.commit();
  }
  EXPECT_FALSE(std::filesystem::exists(path("cave.db-wal"))) << "the log is merged when the map is closed";
  const MapFile map = MapFile::open(path(), MapFile::Access::Read);
  EXPECT_EQ(map.description(), description);
  ASSERT_EQ(map.dives().size(), 1u);
  const MapDive kept = map.findDive("dive 1").value();
  EXPECT_EQ(kept.id, dive.id);
  EXPECT_EQ(kept.recording, dive.recording);
  EXPECT_EQ(kept.fingerprint, dive.fingerprint);
  EXPECT_EQ(kept.start, dive.start);
  EXPECT_EQ(kept.end, dive.end);
  EXPECT_EQ(kept.heading_reference, HeadingReference::Magnetic);
  EXPECT_EQ(kept.rig, dive.rig);
  EXPECT_EQ(kept.depth_reference, dive.depth_reference);
  EXPECT_EQ(kept.settings_digest, dive.settings_digest);
  EXPECT_FALSE(map.findDive("dive 2"));
}

TEST_F(MapFileTest, KeepsKeyframesAndReadsThemOnDemand) {
  MapFile map = MapFile::create(path(), {});
  const DiveId first = addDive(&map, "a", 600, 3), second = addDive(&map, "b", 2);
  std::vector<KeyframeId> ids;
  std::mt19937 same(1);
  int number = 0;
  map.forEachKeyframe(first, [&](const StoredKeyframe& stored) {
    const MapKeyframe expected = test::passageKeyframe(first, number++, 3, &same);
    ids.push_back(stored.keyframe.id);
    EXPECT_EQ(stored.keyframe.time, expected.time);
    EXPECT_TRUE(stored.keyframe.odom_from_body.matrix().isApprox(expected.odom_from_body.matrix(), 1e-15));
    EXPECT_LT((stored.keyframe.covariance - expected.covariance).norm(), 1e-6 * expected.covariance.norm());
    EXPECT_EQ(stored.keyframe.north_from_odom_rad, expected.north_from_odom_rad);
    EXPECT_EQ(stored.keyframe.heading_sigma_rad, expected.heading_sigma_rad);
    EXPECT_EQ(stored.keyframe.depth_m.has_value(), expected.depth_m.has_value());
    ASSERT_EQ(stored.keyframe.field.has_value(), expected.field.has_value());
    if (expected.field) {
      EXPECT_EQ(stored.keyframe.field->field_B, expected.field->field_B);
      EXPECT_EQ(stored.keyframe.field->sigma_T, expected.field->sigma_T);
    }
    EXPECT_THAT(stored.keyframe.features, IsEmpty());
    EXPECT_EQ(stored.feature_count, 3);
    EXPECT_FALSE(stored.solved);
  });
  ASSERT_EQ(ids.size(), 600u);
  EXPECT_TRUE(std::is_sorted(ids.begin(), ids.end()));
  EXPECT_EQ(map.fullKeyframe(ids[5]).features.size(), 3u);
  EXPECT_EQ(map.keyframe(ids[5])->keyframe.dive, first);
  EXPECT_FALSE(map.keyframe(99999));
  EXPECT_THAT(map.features(99999), IsEmpty());
  EXPECT_THAT(errorOf([&] { map.fullKeyframe(99999); }), HasSubstr("cave.db: there is no keyframe 99999"));
  int edges = 0;
  map.forEachEdge(first, [&](const OdometryEdge& edge) {
    EXPECT_EQ(edge.new_keyframe, edge.old_keyframe + 1);
    ++edges;
  });
  EXPECT_EQ(edges, 599);
  EXPECT_NE(first, second);
  EXPECT_THAT(map.check(), IsEmpty());
}

TEST_F(MapFileTest, KeepsSolutionLoopsAndControl) {
  MapFile map = MapFile::create(path(), {});
  addDive(&map, "a", 3);
  Loop loop;
  loop.old_keyframe = 1;
  loop.new_keyframe = 3;
  loop.source = "geometry";
  loop.status = LoopStatus::Verified;
  loop.reason = "not yet";
  loop.matches = 40;
  loop.inliers = 30;
  loop.covered_share = 0.5;
  loop.rms_sigmas = 1.1;
  loop.mahalanobis_squared = 4.5;
  loop.old_from_new = Rigid3(Quat(0.6, 0.8, 0, 0), Vec3(1, 2, 3));
  loop.covariance = 1e-4 * Mat6::Identity();
  loop.inlier_matches = {{0, 19}, {7, 3}};
  MapChange change = map.change();
  const SolvedPose pose{Rigid3(Quat(0.8, 0, 0, 0.6), Vec3(4, 5, 6)), 1e-2 * Mat6::Identity()};
  change.setSolution(2, {});
  change.setSolution(2, pose);
  StoredLoop stored{change.addLoop(loop), loop};
  stored.loop.status = LoopStatus::Accepted;
  stored.loop.reason.clear();
  change.updateLoop(stored);
  ControlPoint point{
      -1, "entrance", ControlKind::Gps, {}, PositionPrior{{1, 2, 3}, 9 * Mat3::Identity()}, "c.csv:2"};
  point.id = change.putControlPoint(point);
  change.putControlPoint({-1, "tag 5", ControlKind::Tag, 5, {}, "seen"});
  change.addControlObservation({point.id, 1, {{0, 0, 0.1}, 0.01 * Mat3::Identity()}});
  point.position->position.x() = 7.0;
  EXPECT_EQ(change.putControlPoint(point), point.id);
  change.commit();

  EXPECT_EQ(map.keyframe(2)->solved->map_from_body.translation, Vec3(4, 5, 6));
  EXPECT_TRUE(map.keyframe(2)->solved->covariance.isApprox(pose.covariance, 1e-6));
  std::vector<StoredLoop> loops;
  map.forEachLoop([&](const StoredLoop& row) { loops.push_back(row); });
  ASSERT_EQ(loops.size(), 1u);
  const Loop& kept = loops[0].loop;
  EXPECT_EQ(kept.status, LoopStatus::Accepted);
  EXPECT_EQ(kept.reason, "");
  EXPECT_EQ(kept.source, "geometry");
  EXPECT_EQ(kept.matches, 40);
  EXPECT_EQ(kept.inliers, 30);
  EXPECT_EQ(kept.mahalanobis_squared, 4.5);
  EXPECT_EQ(kept.old_from_new.translation, Vec3(1, 2, 3));
  ASSERT_EQ(kept.inlier_matches.size(), 2u);
  EXPECT_EQ(kept.inlier_matches[1].old_feature, 7);
  EXPECT_EQ(kept.inlier_matches[0].new_feature, 19);
  ASSERT_EQ(map.controlPoints().size(), 2u);
  EXPECT_EQ(map.controlPoints()[0].position->position, Vec3(7, 2, 3));
  EXPECT_EQ(map.controlPoints()[1].tag, 5);
  EXPECT_FALSE(map.controlPoints()[1].position);
  ASSERT_EQ(map.controlObservations().size(), 1u);
  EXPECT_EQ(map.controlObservations()[0].keyframe, 1);
  EXPECT_THAT(map.check(), IsEmpty());
}

TEST_F(MapFileTest, RemovesADiveWithAllThatBelongsToIt) {
  MapFile map = MapFile::create(path(), {});
  addDive(&map, "a", 3);
  const DiveId second = addDive(&map, "b", 3);
  {
    MapChange change = map.change();
    Loop across;
    across.old_keyframe = 1;
    across.new_keyframe = 5;
    change.addLoop(across);
    across.new_keyframe = 3;
    change.addLoop(across);
    const int64_t tag = change.putControlPoint({-1, "tag 5", ControlKind::Tag, 5, {}, ""});
    change.putControlPoint({-1, "gps", ControlKind::Gps, {}, PositionPrior{}, ""});
    change.addControlObservation({tag, 5, {}});
    change.setSolution(5, {});
    change.commit();
  }
  MapChange change = map.change();
  change.removeDive(second);
  EXPECT_THROW(change.removeDive(second), InputError);
  change.commit();
  const MapSizes sizes = map.sizes();
  EXPECT_EQ(sizes.dives, 1);
  EXPECT_EQ(sizes.keyframes, 3);
  EXPECT_EQ(sizes.features, 60);
  EXPECT_EQ(sizes.edges, 2);
  EXPECT_EQ(sizes.loops, 1);
  EXPECT_EQ(sizes.control_points, 1) << "the tag was seen by the other dive alone";
  EXPECT_THAT(map.controlObservations(), IsEmpty());
  EXPECT_THAT(map.check(), IsEmpty());
  EXPECT_GT(addDive(&map, "c", 1), second) << "numbers are not used again";
  EXPECT_TRUE(map.keyframe(7));
  map.compact();
  EXPECT_EQ(map.sizes().free_bytes, 0);
}

TEST_F(MapFileTest, AChangeIsAllOrNothing) {
  MapFile map = MapFile::create(path(), {});
  addDive(&map, "a", 2);
  {
    MapChange change = map.change();
    EXPECT_THROW(map.change(), std::logic_error);
    change.addDive(test::namedDive("b"));
    const MapFile other = MapFile::open(path(), MapFile::Access::Read);
    EXPECT_EQ(other.dives().size(), 1u);
    EXPECT_EQ(map.dives().size(), 2u);
  }
  EXPECT_EQ(map.dives().size(), 1u);
}

TEST_F(MapFileTest, RefusesWhatNoMapHolds) {
  MapFile map = MapFile::create(path(), {});
  const DiveId dive = addDive(&map, "a", 2);
  MapChange change = map.change();
  MapKeyframe keyframe = test::passageKeyframe(dive, 9, 2, &random_);
  keyframe.id = 2;
  EXPECT_THAT(errorOf([&] { change.addKeyframe(keyframe); }), HasSubstr("keyframe 2 comes after 2"));
  keyframe.id = -1;
  keyframe.odom_from_body.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(errorOf([&] { change.addKeyframe(keyframe); }),
              HasSubstr("keyframe 3: a number is not finite"));
  keyframe = test::passageKeyframe(dive + 7, 9, 2, &random_);
  EXPECT_THAT(errorOf([&] { change.addKeyframe(keyframe); }),
              HasSubstr("cave.db: keyframe 3: does not take"));
  EXPECT_THAT(errorOf([&] { change.addDive(test::namedDive("a")); }), HasSubstr("has a dive 'a' already"));
  EXPECT_THAT(errorOf([&] { change.addDive(test::namedDive("")); }), HasSubstr("needs a name"));
  EXPECT_THAT(errorOf([&] {
                change.addEdge({1, 77, {}, Mat6::Identity()});
              }),
              HasSubstr("edge to keyframe 77"));
  EXPECT_THAT(errorOf([&] {
                change.setSolution(1, {Rigid3(Quat(2, 0, 0, 0), Vec3::Zero()), Mat6::Zero()});
              }),
              HasSubstr("a rotation is not unit"));
  EXPECT_THAT(errorOf([&] { change.addEdge({1, 2, {}, -Mat6::Identity()}); }), HasSubstr("variance"));
  EXPECT_THROW(change.updateLoop({5, {}}), InputError);
  EXPECT_THROW(change.removeControlPoint(5), InputError);
  EXPECT_THROW(change.putControlPoint({}), InputError);
  change.commit();
  EXPECT_THAT(map.check(), IsEmpty());
  EXPECT_EQ(map.sizes().keyframes, 2);
}

TEST_F(MapFileTest, NamesFaultsOfADamagedMap) {
  {
    MapFile map = MapFile::create(path(), {});
    addDive(&map, "a", 4);
  }
  {
    Database database(path(), Database::Mode::Change);
    database.run("PRAGMA foreign_keys = OFF");
    database.run("UPDATE keyframe SET qw = 3 WHERE id = 1");
    database.run("UPDATE keyframe SET covariance = x'00' WHERE id = 2");
    database.run("UPDATE features SET data = substr(data, 1, 60) WHERE keyframe = 3");
    database.run("UPDATE features SET count = 7 WHERE keyframe = 4");
    database.run("UPDATE keyframe SET dive = 9 WHERE id = 4");
    database.run("UPDATE keyframe SET x = 9e999 WHERE id = 3");
  }
  const MapFile map = MapFile::open(path(), MapFile::Access::Read);
  EXPECT_THAT(kindsOf(map.check()),
              ElementsAre("map_reference", "map_row", "map_row", "map_row", "map_features", "map_features"));
  EXPECT_THAT(errorOf([&] { map.features(3); }), HasSubstr("cave.db: features of keyframe 3: "));
  EXPECT_THAT(errorOf([&] { map.keyframe(1); }), HasSubstr("cave.db: keyframe 1: a rotation is not unit"));
}

TEST_F(MapFileTest, NamesFaultsOfOverwrittenPages) {
  {
    MapFile map = MapFile::create(path(), {});
    addDive(&map, "a", 40, 100);
  }
  {
    std::fstream file(path(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(40000);
    file << std::string(30000, '\x5a');
  }
  EXPECT_THAT(MapFile::open(path(), MapFile::Access::Read).check(), Not(IsEmpty()));
}

TEST_F(MapFileTest, TakesFewBytes) {
  MapFile map = MapFile::create(path(), {});
  addDive(&map, "100 m", 300, 400);
  {
    MapChange change = map.change();
    for (KeyframeId id = 1; id <= 300; ++id)
      change.setSolution(id, {Rigid3(), test::someCovariance(0.1, &random_)});
    change.commit();
  }
  const double megabytes = 1e-6 * static_cast<double>(map.sizes().file_bytes);
  map.compact();
  const double compacted = 1e-6 * static_cast<double>(map.sizes().file_bytes);
  RecordProperty("MB_per_100_m", std::to_string(compacted));
  RecordProperty("MB_with_log", std::to_string(megabytes));
  EXPECT_LT(compacted, 5.2) << "5.12 MB were measured; 5 are wanted";
}

}  // namespace
}  // namespace lodeline
