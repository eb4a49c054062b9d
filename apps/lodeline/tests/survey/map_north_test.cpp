#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "apps/lodeline/tests/test_program.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/mapping/graph/motion/level_motion.h"
#include "lodeline/mapping/store/map_file.h"
#include "lodeline/util/files/test_data.h"

// Tests of maps whose dives know different norths, and of runs that begin anywhere in a map, with parts of
// the sample dive.

namespace lodeline {
namespace {

using test::Execution;
using test::quoted;
using test::runProgram;
using ::testing::HasSubstr;
using ::testing::Not;

/// Declination at the place and date of the sample dive by WMM2025.
constexpr double kDeclination_rad = -0.042;

class MapNorth : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    const std::string magnetometer =
        fmt::format("--mag-calibration {}", quoted(sample() / "magnetometer.yaml"));
    const std::string site = " --site 20.32,-87.39,5 --date 2026-11-21";
    for (const auto& [name, options] : {std::pair<std::string, std::string>{"start", "--to 12"},
                                        {"true", "--to 12 " + magnetometer + site},
                                        {"magnetic", "--from 4 --to 12 " + magnetometer}}) {
      const Execution result = run(name, options);
      ASSERT_EQ(result.exit_code, 0) << result.output;
    }
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::filesystem::path sample() { return testSourceDir() / "samples/cave_dive"; }
  static std::filesystem::path result(const std::string& name) { return folder_->path() / name; }
  static Execution run(const std::string& name, const std::string& options) {
    return runProgram(fmt::format("run {} -o {} --no-report --overwrite {}", quoted(sample()),
                                  quoted(result(name)), options));
  }
  static std::filesystem::path map() { return folder_->path() / "cave.db"; }
  /// Builds the map of some of the runs, in this order.
  static std::string build(const std::vector<std::string>& names) {
    std::string command = fmt::format("map build {} --overwrite", quoted(map()));
    for (const std::string& name : names) command += fmt::format(" {}", quoted(result(name)));
    const Execution built = runProgram(command);
    EXPECT_EQ(built.exit_code, 0) << built.output;
    return built.output;
  }
  /// Azimuth, counter-clockwise, of a dive's own north in the map, rad.
  static double northInMap_rad(const std::string& dive) {
    const MapFile file = MapFile::open(map(), MapFile::Access::Read);
    double azimuth_rad = NAN;
    file.forEachKeyframe(file.findDive(dive)->id, [&](const StoredKeyframe& row) {
      const Quat map_from_odom = mapFromOdom(row.solved->map_from_body, row.keyframe.odom_from_body).rotation;
      azimuth_rad = 2.0 * std::atan2(map_from_odom.z(), map_from_odom.w()) - row.keyframe.north_from_odom_rad;
    });
    return azimuth_rad;
  }
  static std::string exported() {
    const Execution result = runProgram(fmt::format(
        "map export {} -o {} --format survex --entrance 20.32,-87.39,5 --date 2026-11-21 --overwrite",
        quoted(map()), quoted(folder_->path() / "survey")));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return test::readText(folder_->path() / "survey/start_notes.txt");
  }

  static test::TemporaryFolder* folder_;
};

test::TemporaryFolder* MapNorth::folder_ = nullptr;

TEST_F(MapNorth, TheBestNorthOfAnyDiveIsThatOfTheMap) {
  EXPECT_THAT(build({"start", "true", "magnetic"}), Not(HasSubstr("dive_not_joined")));
  EXPECT_NEAR(northInMap_rad("true"), 0.0, 0.01);
  EXPECT_NEAR(northInMap_rad("magnetic"), -kDeclination_rad, 0.015);
  EXPECT_THAT(exported(), HasSubstr("true north, as the run found it"));
}

TEST_F(MapNorth, TheOrderOfTheDivesDoesNotMatter) {
  EXPECT_THAT(build({"magnetic", "start", "true"}), Not(HasSubstr("dive_not_joined")));
  EXPECT_NEAR(northInMap_rad("true"), 0.0, 0.01);
  EXPECT_NEAR(northInMap_rad("magnetic"), -kDeclination_rad, 0.015);
}

TEST_F(MapNorth, MagneticNorthIsTakenWhereNoDiveKnowsABetterOne) {
  EXPECT_THAT(build({"start", "magnetic"}), Not(HasSubstr("dive_not_joined")));
  EXPECT_NEAR(northInMap_rad("magnetic"), 0.0, 0.01);
  EXPECT_THAT(exported(), HasSubstr("the run's magnetic north, declination -2.41 deg applied"));
}

TEST_F(MapNorth, ARunFindsItsPlaceWhereverItBegins) {
  const std::string with_map = fmt::format(" --map {}", quoted(result("true") / "map.db"));
  const std::string magnetometer =
      fmt::format(" --mag-calibration {}", quoted(sample() / "magnetometer.yaml"));
  const auto error_m = [&](const std::string& options) {
    const Execution execution = run("later", options + with_map);
    EXPECT_EQ(execution.exit_code, 0) << execution.output;
    EXPECT_THAT(execution.output, HasSubstr("with earlier dives"));
    const nlohmann::json errors = test::evaluateRun(result("later") / "trajectory_map.tum",
                                                    result("true") / "trajectory.tum", "--align none");
    return errors["absolute"]["position_m"]["rmse"].get<double>();
  };
  EXPECT_LT(error_m("--from 4 --to 12"), 0.05);
  EXPECT_LT(error_m("--from 4 --to 12" + magnetometer), 0.05);
  // Over two metres, one camera does not know its scale better than to a few per cent.
  EXPECT_LT(error_m("--from 5 --to 12 --cameras 1" + magnetometer), 0.1);
}

TEST_F(MapNorth, AStatedStartPlacesARunThatRecognizesNothing) {
  // The rig looks the other way by then.
  const Execution execution = run(
      "apart", fmt::format("--from 14 --to 16 --mag-calibration {} --map {} --start 1.5,0.5,-0.5",
                           quoted(sample() / "magnetometer.yaml"), quoted(result("magnetic") / "map.db")));
  ASSERT_EQ(execution.exit_code, 0) << execution.output;
  EXPECT_THAT(execution.output, Not(HasSubstr("no place of this map")));
  EXPECT_THAT(execution.output, Not(HasSubstr("with earlier dives")));
  Diagnostics diagnostics;
  const Trajectory in_map = readTrajectory(result("apart") / "trajectory_map.tum", {}, diagnostics);
  ASSERT_FALSE(in_map.poses.empty());
  EXPECT_LT((in_map.poses.front().world_from_body.translation - Vec3(1.5, 0.5, -0.5)).norm(), 0.1);
}

}  // namespace
}  // namespace lodeline
