#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <string>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/output/survey/formats/map_files.h"
#include "lodeline/output/survey/formats/test_outside_program.h"
#include "lodeline/output/survey/map/test_dive.h"
#include "lodeline/util/files/output_file.h"

/// Builds exported files with Survex's cavern and Therion.
namespace lodeline::test {

/// Positions by the numbers of stations.
using Stations = std::map<int, Vec3>;

inline DiveMapOptions devilsEye() {
  DiveMapOptions options;
  options.title = "Devil's Eye";
  options.team = {"A. Diver", "Ärztin B"};
  options.entrance = kDevilsEye;
  options.start_depth_m = 1.5;
  return options;
}

// Both programs give positions in centimetres.
inline constexpr double kHalfCentimetre_m = 0.0051;

/// Compares the stations with those of the map and the poses on the grid.
inline void expectAt(const Stations& stations, const DiveMap& map) {
  ASSERT_EQ(stations.size(), map.survey.stations.size());
  for (const auto& [index, position] : stations) {
    const Vec3 point = map.survey.stations[static_cast<size_t>(index)].position_ENU;
    const Vec3 expected =
        map.place ? map.place->grid(point) : Vec3(point - map.start_depth_m * Vec3::UnitZ());
    EXPECT_LT((position - expected).cwiseAbs().maxCoeff(), kHalfCentimetre_m) << "station " << index;
  }
}

class SurveyPrograms : public ::testing::Test {
 protected:
  DiveMap write(const RunFolder& run, const DiveMapOptions& options) {
    Diagnostics diagnostics;
    const DiveMap map = makeDiveMap(run, options, {}, &diagnostics);
    writeMap(map, std::nullopt, MapFormat::Survex, folder_.path());
    writeMap(map, std::nullopt, MapFormat::Therion, folder_.path());
    return map;
  }

  /// Stations from cavern; the file must be accepted without any warning.
  Stations cavern(const std::string& name) const {
    const OutsideRun run = runIn(folder_.path(), "LC_ALL=C.UTF-8 cavern " + name + ".svx");
    EXPECT_EQ(run.exit_code, 0) << run.output;
    EXPECT_THAT(run.output, ::testing::Not(::testing::AnyOf(::testing::HasSubstr("warning"),
                                                            ::testing::HasSubstr("error"))))
        << run.output;
    const std::string dump = runIn(folder_.path(), "dump3d " + name + ".3d").output;
    static const std::regex kNode(R"(NODE (\S+) (\S+) (\S+) \[[^\]]+\.(\d+)\])");
    Stations stations;
    for (std::sregex_iterator node(dump.begin(), dump.end(), kNode), end; node != end; ++node) {
      stations[std::stoi((*node)[4])] =
          Vec3(std::stod((*node)[1]), std::stod((*node)[2]), std::stod((*node)[3]));
    }
    return stations;
  }

  /// The same from Therion.
  Stations therion(const std::string& name) const {
    writeOutput(folder_.path() / "test.thconfig",
                runIn(folder_.path(), "cat " + name + ".thconfig").output + "export database -o test.sql\n");
    const OutsideRun run = runIn(folder_.path(), "therion test.thconfig");
    EXPECT_EQ(run.exit_code, 0) << run.output;
    EXPECT_THAT(run.output, ::testing::Not(::testing::AnyOf(::testing::HasSubstr("warning"),
                                                            ::testing::HasSubstr("error --"))))
        << run.output;
    const std::string sql = runIn(folder_.path(), "cat test.sql").output;
    static const std::regex kStation(
        R"(insert into STATION values \(\d+, '(\d+)', \d+, (\S+), (\S+), (\S+)\))");
    Stations stations;
    for (std::sregex_iterator row(sql.begin(), sql.end(), kStation), end; row != end; ++row) {
      stations[std::stoi((*row)[1])] = Vec3(std::stod((*row)[2]), std::stod((*row)[3]), std::stod((*row)[4]));
    }
    return stations;
  }

  /// Both programs must accept the map with its stations at the poses.
  void expectBothAt(const DiveMap& map) const {
    expectAt(cavern(map.name), map);
    expectAt(therion(map.name), map);
  }

  void replaceIn(const std::string& file, const std::string& pattern, const std::string& by) const {
    const std::string text = runIn(folder_.path(), "cat " + file).output;
    writeOutput(folder_.path() / file, std::regex_replace(text, std::regex(pattern), by));
  }

  TemporaryFolder folder_;
};

}  // namespace lodeline::test
