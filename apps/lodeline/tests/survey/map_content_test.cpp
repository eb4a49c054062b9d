#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/lodeline/tests/test_program.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/mapping/store/map_change.h"
#include "lodeline/mapping/store/sqlite/database.h"

// Tests of `lodeline map info`, `check`, `remove` and `control` as a program.

namespace lodeline {
namespace {

using test::Execution;
using test::runProgram;
using ::testing::HasSubstr;

class MapContentTest : public ::testing::Test {
 protected:
  /// A map of two dives of ten solved keyframes each, a second and a metre apart, along east.
  void SetUp() override {
    MapDescription description;
    description.site = GeodeticPosition{20.5, -87.4, 8.0};
    MapFile map = MapFile::create(path(), description);
    MapChange change = map.change();
    for (const char* name : {"dive1", "dive2"}) {
      MapDive dive;
      dive.name = name;
      dive.start = dive.end.emplace(Time::fromNanoseconds(1795255200000000000));
      MapKeyframe keyframe;
      keyframe.dive = change.addDive(dive);
      for (int i = 0; i < 10; ++i) {
        keyframe.time = dive.start + Duration::fromSeconds(i);
        keyframe.odom_from_body.translation = Vec3(i, 0, 0);
        change.setSolution(change.addKeyframe(keyframe), {keyframe.odom_from_body, 1e-4 * Mat6::Identity()});
      }
    }
    change.commit();
  }
  std::filesystem::path path() const { return folder_.path() / "cave.db"; }
  Execution map(const std::string& command, const std::string& rest = "") const {
    return runProgram("map " + command + " " + test::quoted(path()) + " " + rest);
  }
  Execution addControl(const std::string& rows) const {
    return map("control",
               test::quoted(folder_.write("control.csv", "name,kind,east,north,up,time,dive\n" + rows)));
  }

  test::TemporaryFolder folder_;
};

TEST_F(MapContentTest, ShowsResidualsAndBlundersOfControlPoints) {
  const Execution added =
      addControl("A,station,3,0,0,3,dive1\nB,station,5,20,0,5,dive2\nC,tie,,,,8,dive1\nC,tie,,,,8,dive2\n");
  ASSERT_EQ(added.exit_code, 0) << added.output;
  EXPECT_THAT(added.output, HasSubstr("3 control points and 4 visits added"));
  const Execution info = map("info");
  ASSERT_EQ(info.exit_code, 0) << info.output;
  EXPECT_THAT(info.output,
              HasSubstr("blunder: station 'B': keyframe 16 shows it 20.00 m from its stated position"));
  const auto json = nlohmann::json::parse(map("info", "--json").output);
  EXPECT_EQ(json["dives"].size(), 2u);
  EXPECT_EQ(json["dives"][0]["keyframes"], 10);
  EXPECT_NEAR(json["dives"][0]["path_m"], 9.0, 1e-9);
  ASSERT_EQ(json["control_residuals"].size(), 4u);
  EXPECT_EQ(json["control_residuals"][0]["name"], "A");
  EXPECT_NEAR(json["control_residuals"][0]["error_m"][0], 0.0, 1e-9);
  for (const auto& residual : json["control_residuals"])
    EXPECT_EQ(residual["is_blunder"].get<bool>(), residual["name"] == "B") << residual;
}

TEST_F(MapContentTest, NamesVisitsThatFitNoDive) {
  EXPECT_THAT(addControl("A,station,3,0,0,3,\n").output, HasSubstr("control.csv:2: more than one dive"));
  EXPECT_THAT(addControl("A,station,3,0,0,3,dive9\n").output, HasSubstr("no dive of the map fits"));
  const Execution late = addControl("A,station,3,0,0,300,dive1\n");
  EXPECT_EQ(late.exit_code, 1);
  EXPECT_THAT(late.output, HasSubstr("no keyframes around the visit of 'A'"));
  EXPECT_TRUE(MapFile::open(path(), MapFile::Access::Read).controlPoints().empty()) << "all or nothing";
}

TEST_F(MapContentTest, ChecksAMap) {
  EXPECT_EQ(map("check").exit_code, 0);
  Database(path(), Database::Mode::Change).run("UPDATE keyframe SET qw = 2 WHERE id = 3");
  const Execution damaged = map("check");
  EXPECT_EQ(damaged.exit_code, 1);
  EXPECT_THAT(damaged.output, HasSubstr("serious [map_row]: keyframe 3: a rotation is not unit"));
}

TEST_F(MapContentTest, RemovesADive) {
  EXPECT_EQ(map("remove", "dive9").exit_code, 2);
  ASSERT_EQ(map("remove", "dive1").exit_code, 0);
  const MapFile left = MapFile::open(path(), MapFile::Access::Read);
  ASSERT_EQ(left.dives().size(), 1u);
  EXPECT_EQ(left.dives().front().name, "dive2");
  EXPECT_EQ(left.sizes().keyframes, 10);
}

}  // namespace
}  // namespace lodeline
