#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <sstream>

#include "apps/lodeline/tests/survey/test_cave_map.h"
#include "apps/lodeline/tests/test_program.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/output/survey/formats/test_outside_program.h"

// Tests of `lodeline survey` with cavern and therion.

namespace lodeline {
namespace {

using test::Execution;
using test::runProgram;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Position on the grid by "dive.number".
using Stations = std::map<std::string, Vec3>;

/// A row of NAME_stations.csv.
struct StationRow {
  std::string name;
  int64_t stamp_ns = 0;
  Vec3 position_ENU, sigma_ENU, grid;
};

std::vector<std::string> fieldsOf(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

class SurveyProjectTest : public ::testing::Test {
 protected:
  Execution survey(const std::string& arguments) const {
    return runProgram("survey " + arguments + " -o " + test::quoted(folder_.path() / "out"));
  }
  std::filesystem::path mapFile() const { return folder_.path() / "cave.db"; }
  std::string text(const std::string& name) const { return test::readText(folder_.path() / "out" / name); }

  std::vector<StationRow> rows(const std::string& name) const {
    std::vector<StationRow> rows;
    std::istringstream stream(text(name + "_stations.csv"));
    std::string line;
    std::getline(stream, line);
    while (std::getline(stream, line)) {
      const std::vector<std::string> f = fieldsOf(line);
      const auto at = [&](size_t i) { return f[i].empty() ? 0.0 : std::stod(f[i]); };
      rows.push_back({f[0] + "." + f[1], std::stoll(f[2]), Vec3(at(3), at(4), at(5)),
                      Vec3(at(12), at(13), at(14)), Vec3(at(10), at(11), at(9))});
    }
    return rows;
  }

  Stations cavern(const std::string& name) const {
    const auto out = folder_.path() / "out";
    const test::OutsideRun run = test::runIn(out, "LC_ALL=C.UTF-8 cavern " + name + ".svx");
    EXPECT_EQ(run.exit_code, 0) << run.output;
    EXPECT_THAT(run.output, Not(AnyOf(HasSubstr("warning"), HasSubstr("error")))) << run.output;
    const std::string dump = test::runIn(out, "dump3d " + name + ".3d").output;
    static const std::regex kNode(R"(NODE (\S+) (\S+) (\S+) \[(?:\w+\.)?(\w+\.\w+)\])");
    Stations stations;
    for (std::sregex_iterator node(dump.begin(), dump.end(), kNode), end; node != end; ++node)
      stations[(*node)[4]] = Vec3(std::stod((*node)[1]), std::stod((*node)[2]), std::stod((*node)[3]));
    return stations;
  }

  Stations therion(const std::string& name) const {
    const auto out = folder_.path() / "out";
    test::runIn(
        out, "cp " + name + ".thconfig test.thconfig; echo 'export database -o test.sql' >> test.thconfig");
    const test::OutsideRun run = test::runIn(out, "therion test.thconfig");
    EXPECT_EQ(run.exit_code, 0) << run.output;
    EXPECT_THAT(run.output, Not(AnyOf(HasSubstr("warning"), HasSubstr("error --")))) << run.output;
    const std::string sql = test::runIn(out, "cat test.sql").output;
    std::map<std::string, std::string> surveys;
    static const std::regex kSurvey(R"(insert into SURVEY values \((\d+), \S+, '([^']*)')");
    for (std::sregex_iterator row(sql.begin(), sql.end(), kSurvey), end; row != end; ++row)
      surveys[(*row)[1]] = (*row)[2];
    static const std::regex kStation(
        R"(insert into STATION values \(\d+, '(\w+)', (\d+), (\S+), (\S+), (\S+)\))");
    Stations stations;
    for (std::sregex_iterator row(sql.begin(), sql.end(), kStation), end; row != end; ++row) {
      stations[surveys[(*row)[2]] + "." + (*row)[1].str()] =
          Vec3(std::stod((*row)[3]), std::stod((*row)[4]), std::stod((*row)[5]));
    }
    return stations;
  }

  test::TemporaryFolder folder_;
};

constexpr double kCentimetre_m = 0.0101;

TEST_F(SurveyProjectTest, MakesOneCaveOfThreeDives) {
  LODELINE_NEEDS_PROGRAM("cavern", "survex");
  LODELINE_NEEDS_PROGRAM("therion", "therion");
  const test::CaveMap cave(mapFile(), 1);
  ASSERT_THAT(cave.unconnected, ::testing::IsEmpty());
  folder_.write("control.csv",
                fmt::format("name,kind,east,north,up,horizontal sigma [m],vertical sigma [m],time,dive\n"
                            "B,gps,{},{},{},1,2,3,sink\nT 4,tie,,,,,,120,upstream\n",
                            cave.entrance_B.x() + 0.4, cave.entrance_B.y(), cave.entrance_B.z()));
  folder_.write("cave.yaml",
                "map: cave.db\ncontrol: control.csv\ntitle: Three dives\nteam: A. Diver\ncrs: EPSG:6438\n"
                "vertical_datum: EPSG:5703\nentrance: 29°49'48\"N 82°36'W 10\ndives:\n"
                "  - {dive: loop, date: 2023-05-01, title: The loop, team: [B. Other, C. Third]}\n");
  const Execution result = survey(test::quoted(folder_.path() / "cave.yaml"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const std::vector<StationRow> stations = rows("cave");
  const Stations by_cavern = cavern("cave"), by_therion = therion("cave");
  double worst_sigmas = 0.0, worst_misfit_m = 0.0, worst_table_m = 0.0;
  for (const StationRow& row : stations) {
    SCOPED_TRACE(row.name);
    ASSERT_TRUE(by_cavern.contains(row.name));
    ASSERT_TRUE(by_therion.contains(row.name));
    worst_misfit_m = std::max(worst_misfit_m, (by_cavern.at(row.name) - by_therion.at(row.name)).norm());
    constexpr double kFoot_m = 1200.0 / 3937.0;
    const Vec3 grid_m(row.grid.x() * kFoot_m, row.grid.y() * kFoot_m, row.grid.z());
    worst_table_m = std::max(worst_table_m, (by_cavern.at(row.name) - grid_m).cwiseAbs().maxCoeff());
    const Vec3 error = row.position_ENU - cave.truth.at(row.stamp_ns);
    const Vec3 sigmas = error.array().abs() / row.sigma_ENU.array().max(0.01);
    worst_sigmas = std::max(worst_sigmas, sigmas.maxCoeff());
    // A dive that floats would be within any number of sigmas. Only the GPS fix states a height, with 2 m.
    EXPECT_LT(row.sigma_ENU.head<2>().maxCoeff(), 2.0);
    EXPECT_GT(row.sigma_ENU.z(), 2.0);
    EXPECT_LT(row.sigma_ENU.z(), 2.1);
  }
  EXPECT_LE(worst_misfit_m, kCentimetre_m);
  EXPECT_LE(worst_table_m, kCentimetre_m);
  EXPECT_LE(worst_sigmas, 3.0);
  // Each passage once: 5 m between stations, no doubled line.
  EXPECT_THAT(result.output, HasSubstr("loops: 1"));
  static const std::regex kLength(R"(stations, ([0-9.]+) m of passages)");
  std::smatch length;
  ASSERT_TRUE(std::regex_search(result.output, length, kLength));
  EXPECT_NEAR(std::stod(length[1]), cave.passages_m, 0.04 * cave.passages_m);
  const std::string svx = text("cave.svx");
  EXPECT_THAT(svx, HasSubstr("*date 2023.05.01"));
  EXPECT_THAT(svx, HasSubstr("on 2023-05-01 (WMM2020)"));
  EXPECT_THAT(svx, HasSubstr("(WMM2025)"));
  EXPECT_THAT(svx, HasSubstr("heights: in metres above NAVD88 height (EPSG:5703)"));
  EXPECT_THAT(svx, HasSubstr("*entrance upstream.0"));
  EXPECT_THAT(svx, HasSubstr("*entrance sink.0"));
  EXPECT_THAT(svx, HasSubstr("c_T_4"));
}

TEST_F(SurveyProjectTest, TakesAMapAloneAndKeepsEveryWayIfAsked) {
  LODELINE_NEEDS_PROGRAM("cavern", "survex");
  LODELINE_NEEDS_PROGRAM("therion", "therion");
  const test::CaveMap cave(mapFile(), 2);
  ASSERT_EQ(survey(test::quoted(mapFile())).exit_code, 0);
  const size_t merged = cavern("cave").size();
  EXPECT_EQ(therion("cave").size(), merged);
  ASSERT_EQ(survey(test::quoted(mapFile()) + " --merge 0").exit_code, 0);
  EXPECT_GT(cavern("cave").size(), merged * 2);
  EXPECT_EQ(therion("cave").size(), cavern("cave").size());
}

TEST_F(SurveyProjectTest, NamesWhatIsWrongInAProject) {
  const test::CaveMap cave(mapFile(), 3);
  const auto expectError = [&](const std::string& yaml, int exit_code, const char* says) {
    const Execution result = survey(test::quoted(folder_.write("wrong.yaml", yaml)));
    EXPECT_EQ(result.exit_code, exit_code) << yaml << result.output;
    EXPECT_THAT(result.output, HasSubstr(says)) << yaml;
  };
  expectError("map: cave.db\nspaceing: 5\n", 1, "wrong.yaml:2: unknown key 'spaceing'");
  expectError("map: cave.db\nspacing: far\n", 1, "wrong.yaml:2: spacing");
  expectError("map: cave.db\ndives: [{dive: nowhere}]\n", 1, "no dive 'nowhere'");
  expectError("name: x\n", 1, "'map'");
  expectError("dives: [{dive: loop}]\n", 1, "wants its 'run'");
  expectError("map: [\n", 1, "wrong.yaml:");
  expectError("map: cave.db\nentrance: here\n", 2, "a place is wanted");
  expectError("map: cave.db\nentrance: 29.8,-82.6,1\ndives: [{dive: loop, date: 2023-02-30}]\n", 2,
              "2023-02-30");
  EXPECT_EQ(survey(test::quoted(folder_.path() / "none.yaml")).exit_code, 1);
}

}  // namespace
}  // namespace lodeline
