#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "apps/lodeline/tests/test_program.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

// Tests of `lodeline export` as a program.

namespace lodeline {
namespace {

using test::Execution;
using test::runProgram;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class ExportTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string poses;
    for (int i = 0; i <= 200; ++i) {
      poses += fmt::format("{}.5 {:.3f} {:.3f} {:.3f} 0 0 0 1\n", 1795255200 + i, 0.1 * i, 0.002 * i * i,
                           -0.01 * i);
    }
    folder_.write("run/trajectory.tum", poses);
    setNorth("true north");
  }
  void setNorth(const std::string& north) {
    folder_.write("run/run.json", fmt::format(R"({{"heading": {{"reference": "{}"}}}})", north));
  }
  Execution exportRun(const std::string& arguments) {
    return runProgram("export " + test::quoted(folder_.path() / "run") + " " + arguments);
  }
  std::string text(const std::string& file) const {
    return test::readText(folder_.path() / "run" / "export" / file);
  }

  static std::string flatProfile() {
    std::string text = "time,depth\n";
    for (int i = 0; i < 700; i += 10) text += fmt::format("{},6.0\n", i);
    return text;
  }

  test::TemporaryFolder folder_;
};

TEST_F(ExportTest, WritesWhatIsAskedForWithItsOrigin) {
  const Execution result = exportRun(
      "--format survex,therion,geojson --format kml,gpx,ply,csv,tum --entrance 29.83,-82.6,10 --title "
      "'Devil'\\''s Eye' "
      "--team 'A. Diver'");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  for (const char* name : {"run.svx", "run.th", "run.thconfig", "run.geojson", "run.kml", "run.gpx",
                           "run.ply", "run_stations.csv", "run_poses.csv", "run.tum"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "run" / "export" / name)) << name;
  }
  EXPECT_THAT(text("run.svx"), HasSubstr("; north: true north, as the run found it"));
  EXPECT_THAT(text("run.svx"), HasSubstr("*title \"Devil's Eye\""));
  EXPECT_THAT(text("run.svx"), HasSubstr("*date 2026.11.21"));  // from the stamps
  EXPECT_THAT(text("run.th"), HasSubstr("team \"A. Diver\""));
  EXPECT_THAT(result.output, HasSubstr("end from start"));
}

TEST_F(ExportTest, GivesTheSameBytesTwice) {
  ASSERT_EQ(exportRun("-f survex,ply --entrance 29.83,-82.6,10").exit_code, 0);
  const std::string survex = text("run.svx"), ply = text("run.ply");
  ASSERT_EQ(exportRun("-f survex,ply --entrance 29.83,-82.6,10").exit_code, 0);
  EXPECT_EQ(text("run.svx"), survex);
  EXPECT_EQ(text("run.ply"), ply);
}

TEST_F(ExportTest, TakesTheEntranceInTheUsualSpellingsAndFormatsInAnyCase) {
  ASSERT_EQ(exportRun("-f survex --entrance 29.83,-82.6,10").exit_code, 0);
  const std::string expected = text("run.svx");
  for (const char* entrance :
       {"'29.83 -82.6 10'", "29.83 -82.6 10", "'29.83, -82.6, 10'", "'29.83;-82.6;10'"}) {
    const Execution result = exportRun(std::string("-f SURVEX --entrance ") + entrance);
    ASSERT_EQ(result.exit_code, 0) << entrance << result.output;
    EXPECT_EQ(text("run.svx"), expected) << entrance;
  }
}

TEST_F(ExportTest, PutsTheEntranceAboveTheDepthThatTheRunMeasured) {
  folder_.write("run/run.json",
                R"({"heading": {"reference": "true north"},
          "pressure": {"gauge": {"depth_at_origin_m": 6.15205, "density_ratio": 1.025}}})");
  const Execution result = exportRun("-f survex,kml --entrance 29.83,-82.6,5");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(text("run.svx"),
              HasSubstr("height -1.00 m, 6.00 m under water (by the run's own pressure sensor)"));
  EXPECT_THAT(text("run.kml"), HasSubstr(",-1.002"));
  ASSERT_EQ(exportRun("-f survex --entrance 29.83,-82.6,5 --start-depth 2").exit_code, 0);
  EXPECT_THAT(text("run.svx"), HasSubstr("height 3.00 m, 2.00 m under water (by --start-depth)"));
  setNorth("true north");
  const Execution unknown = exportRun("-f survex --entrance 29.83,-82.6,5");
  EXPECT_THAT(unknown.output, HasSubstr("nothing states how deep the first pose was"));
}

TEST_F(ExportTest, RefusesAnEntranceFarFromTheSiteOfTheRun) {
  folder_.write("run/config.yaml", "heading: {site: [46.1, 14.2, 400], date: 2026-11-21}\n");
  EXPECT_EQ(exportRun("-f kml --entrance 46.3,14.0,300").exit_code, 0);
  const Execution swapped = exportRun("-f kml --entrance 14.2,46.1,400");
  EXPECT_EQ(swapped.exit_code, 2);
  EXPECT_THAT(swapped.output, HasSubstr("seem to be swapped"));
  const Execution elsewhere = exportRun("-f kml --entrance 29.83,-82.6,10");
  EXPECT_EQ(elsewhere.exit_code, 2);
  EXPECT_THAT(elsewhere.output, HasSubstr("--site 46.1,14.2"));
}

TEST_F(ExportTest, KeepsTheFilesOfAnotherDive) {
  const std::string maps = " -o " + test::quoted(folder_.path() / "maps");
  ASSERT_EQ(exportRun("-f csv" + maps).exit_code, 0);
  ASSERT_EQ(exportRun("-f csv,survex" + maps).exit_code, 0) << "its own";
  const std::string first = test::readText(folder_.path() / "maps" / "run_stations.csv");
  std::string poses;
  for (int i = 0; i <= 200; ++i) poses += fmt::format("{}.5 {:.3f} 0 0 0 0 0 1\n", 1795345200 + i, 0.2 * i);
  folder_.write("other/run/trajectory.tum", poses);
  const std::string other = "export " + test::quoted(folder_.path() / "other" / "run") + " -f csv" + maps;
  const Execution refused = runProgram(other);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, HasSubstr("not of this dive"));
  EXPECT_EQ(test::readText(folder_.path() / "maps" / "run_stations.csv"), first);
  EXPECT_EQ(runProgram(other + " --name other").exit_code, 0);
  EXPECT_EQ(runProgram(other + " --overwrite").exit_code, 0);
  EXPECT_NE(test::readText(folder_.path() / "maps" / "run_stations.csv"), first);
}

TEST_F(ExportTest, JoinsSeveralRunsOnOneGrid) {
  std::filesystem::create_directories(folder_.path() / "second");
  std::filesystem::copy(folder_.path() / "run", folder_.path() / "second" / "run");
  // Two entrances a few metres apart, on both sides of the boundary of two UTM zones.
  folder_.write("run/config.yaml", "heading: {site: [20.0, -90.00005, 5]}\n");
  folder_.write("second/run/config.yaml", "heading: {site: [20.0, -89.99995, 5]}\n");
  const auto runs =
      test::quoted(folder_.path() / "run") + " " + test::quoted(folder_.path() / "second" / "run");
  const Execution result = runProgram("export " + runs + " -f survex,therion --name cave -o " +
                                      test::quoted(folder_.path() / "maps"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const auto map = [&](const std::string& file) { return test::readText(folder_.path() / "maps" / file); };
  const std::string name = folder_.path().filename().string();
  EXPECT_THAT(map("cave.svx"), HasSubstr("*include second_run"));
  EXPECT_THAT(map("cave.th"), HasSubstr("input second_run.th"));
  EXPECT_THAT(map("second_run.svx"), HasSubstr("*cs UTM15N"));
  EXPECT_THAT(result.output, HasSubstr("UTM15N (WGS 84 / UTM zone 15N"));
  EXPECT_THAT(result.output, ::testing::Not(HasSubstr("UTM16N")));
  EXPECT_EQ(runProgram("export " + runs + " -f survex").exit_code, 2) << "no folder named";
  const Execution twice = exportRun(test::quoted(folder_.path() / "run") + " -f survex -o maps");
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_THAT(twice.output, HasSubstr("named twice"));
}

TEST_F(ExportTest, AppliesTheDeclinationAndSaysSo) {
  setNorth("magnetic north");
  const Execution result = exportRun("-f survex --entrance 29.83,-82.6,10");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(text("run.svx"), HasSubstr("declination -6.38 deg applied (WMM2025, entrance, 2026-11-21)"));
}

TEST_F(ExportTest, EndsWithTwoOnWrongUsage) {
  const auto expectUsageError = [&](const std::string& arguments, const char* says) {
    const Execution result = exportRun(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments << result.output;
    EXPECT_THAT(result.output, HasSubstr(says)) << arguments;
  };
  expectUsageError("", "--format");
  expectUsageError("-f csv --correct-depth", "--depth-profile");
  expectUsageError("-f dwg", "survex, therion");
  expectUsageError("-f kml", "--entrance");
  expectUsageError("-f kml --entrance 29.83", "--entrance");
  expectUsageError("-f kml --entrance 129.83,-82.6,0", "latitude");
  expectUsageError("-f kml --entrance 29.83,-82.6,0 --crs EPSG:2154", "cannot be given in EPSG:2154");
  expectUsageError("-f kml --entrance 29.83,-82.6,0 --crs EPSG:4326", "projected grid");
  expectUsageError("-f kml --entrance 129.83,-82.6,0", "latitude");
  expectUsageError("-f kml --entrance 102.6,29.83,0", "swapped");
  expectUsageError("-f kml --entrance 29.83,-82.6,nan", "LAT,LON,HEIGHT");
  expectUsageError("-f kml --entrance 29.83,-82.6,10 --start-depth nan", "--start-depth");
  expectUsageError("-f kml --entrance 29.83,-82.6,10 --entrance-sigma 3,-5", "--entrance-sigma");
  expectUsageError("-f kml --entrance 29.83,-82.6,10 --geoid-height inf", "--geoid-height");
  expectUsageError("-f survex --date 21.11.2026", "YYYY-MM-DD");
  expectUsageError("-f colmap", "--recording");
  setNorth("start heading");
  expectUsageError("-f survex --entrance 29.83,-82.6,0", "--turn");
}

TEST_F(ExportTest, ComparesAndCorrectsByADepthProfile) {
  std::string poses, profile = "time,depth (ft)\n";
  for (int i = 0; i <= 600; ++i) {
    const double depth_m = 5.0 + 3.0 * std::sin(i / 40.0) + 0.01 * i;
    poses +=
        fmt::format("{}.5 {:.3f} 0 {:.4f} 0 0 0 1\n", 1795255200 + i, 0.1 * i, 5.0 - depth_m + 0.001 * i);
    if (i % 10 == 0)
      profile += fmt::format("{}:{:02},{:.1f}\n", (i + 30) / 60, (i + 30) % 60, depth_m / 0.3048);
  }
  folder_.write("run/trajectory.tum", poses);
  const std::string file = test::quoted(folder_.write("computer.csv", profile));
  const Execution compared = exportRun("--depth-profile " + file);
  ASSERT_EQ(compared.exit_code, 0) << compared.output;
  EXPECT_THAT(compared.output, HasSubstr("only compared"));
  EXPECT_THAT(text("run_depth_profile.csv"), StartsWith("time [s],run_depth [m],profile_depth [m]"));
  const Execution corrected = exportRun("-f csv --correct-depth --depth-profile " + file);
  ASSERT_EQ(corrected.exit_code, 0) << corrected.output;
  EXPECT_THAT(text("run_notes.txt"), HasSubstr("vertical: corrected by the depth profile"));
  const Execution uncertain = exportRun("-f csv --correct-depth --depth-profile " +
                                        test::quoted(folder_.write("flat.csv", flatProfile())));
  EXPECT_EQ(uncertain.exit_code, 1);
  EXPECT_THAT(uncertain.output, HasSubstr("--profile-lag"));
}

// Profiles in another unit, and flat ones.
TEST_F(ExportTest, TakesNothingFromAProfileThatIsDoubted) {
  std::string poses, metres = "time [s],depth [m]\n", average = "time [s],Average Depth (m),Depth (m)\n";
  std::string feet_as_metres = metres, flat = metres, unknown = "time [s],depth [fathom]\n";
  double sum = 0.0;
  for (int i = 0; i <= 600; ++i) {
    const double depth_m = 5.0 + 3.0 * std::sin(i / 40.0) + 0.01 * i;
    poses += fmt::format("{}.5 {:.3f} 0 {:.4f} 0 0 0 1\n", 1795255200 + i, 0.1 * i, 5.0 - depth_m);
    sum += depth_m;
    if (i % 10 != 0) continue;
    metres += fmt::format("{},{:.1f}\n", i, depth_m);
    average += fmt::format("{},{:.1f},{:.1f}\n", i, sum / (i + 1), depth_m);
    feet_as_metres += fmt::format("{},{:.1f}\n", i, depth_m / 0.3048);
    flat += fmt::format("{},17.0\n", i);
    unknown += fmt::format("{},{:.1f}\n", i, depth_m);
  }
  folder_.write("run/trajectory.tum", poses);
  const auto exported = [&](const std::string& profile, const std::string& more = "") {
    return exportRun("-f survex --entrance 29.83,-82.6,10 --depth-profile " +
                     test::quoted(folder_.write("p.csv", profile)) + more);
  };
  const std::string taken = "5.00 m under water (by the depth profile)";
  EXPECT_THAT(exported(metres).output, HasSubstr(taken));
  EXPECT_THAT(exported(average).output, HasSubstr(taken));
  for (const std::string& profile : {feet_as_metres, flat}) {
    const Execution doubted = exported(profile);
    EXPECT_EQ(doubted.exit_code, 0) << doubted.output;
    EXPECT_THAT(text("run.svx"), HasSubstr("height 10.00 m, 0.00 m under water (assumed"));
    EXPECT_THAT(doubted.output, HasSubstr("the map takes nothing from it"));
    EXPECT_EQ(exported(profile, " --correct-depth").exit_code, 1);
  }
  EXPECT_THAT(exported(feet_as_metres).output, HasSubstr("as feet"));
  const Execution refused = exported(unknown);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.output, HasSubstr("fathom"));
  folder_.write(
      "run/run.json",
      R"({"heading": {"reference": "true north"}, "pressure": {"gauge": {"depth_at_origin_m": 8.0}}})");
  EXPECT_THAT(exported(metres).output, HasSubstr("8.00 m by the run's own pressure sensor"));
  EXPECT_THAT(exported(flat).output, HasSubstr("8.00 m under water (by the run's own pressure sensor)"));
}

TEST_F(ExportTest, EndsWithOneOnBadInput) {
  const Execution nowhere = runProgram("export /nowhere -f survex");
  EXPECT_EQ(nowhere.exit_code, 1);
  EXPECT_THAT(nowhere.output, HasSubstr("lodeline run -o"));
  folder_.write("run/trajectory.tum", "1.0 0 0 0 0 0 0 1\n2.0 0 0 0 0 0 0 1\n");
  const Execution still = exportRun("-f survex");
  EXPECT_EQ(still.exit_code, 1);
  EXPECT_THAT(still.output, HasSubstr("did not move"));
}

}  // namespace
}  // namespace lodeline
