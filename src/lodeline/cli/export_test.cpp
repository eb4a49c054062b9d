#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/cli/test_program.h"
#include "lodeline/evaluation/test_trajectories.h"

// `lodeline export` as a script sees it.

namespace lodeline {
namespace {

using test::Execution;
using test::runProgram;
using ::testing::HasSubstr;

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
  expectUsageError("-f dxf", "survex, therion");
  expectUsageError("-f kml", "--entrance");
  expectUsageError("-f kml --entrance 29.83", "--entrance");
  expectUsageError("-f kml --entrance 129.83,-82.6,0", "latitude");
  expectUsageError("-f kml --entrance 29.83,-82.6,0 --crs EPSG:2154", "UTM17N");
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
  EXPECT_THAT(text("depth_profile.csv"), HasSubstr("profile_less_run [m]"));
  const Execution corrected = exportRun("-f csv --correct-depth --depth-profile " + file);
  ASSERT_EQ(corrected.exit_code, 0) << corrected.output;
  EXPECT_THAT(text("run_stations.csv"), HasSubstr("vertical: corrected by the depth profile"));
  const Execution uncertain = exportRun("-f csv --correct-depth --depth-profile " +
                                        test::quoted(folder_.write("flat.csv", flatProfile())));
  EXPECT_EQ(uncertain.exit_code, 1);
  EXPECT_THAT(uncertain.output, HasSubstr("--profile-lag"));
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
