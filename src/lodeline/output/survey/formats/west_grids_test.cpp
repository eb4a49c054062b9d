#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <utility>

#include "lodeline/output/survey/formats/test_survey_programs.h"

// Grids that count to the west and south: what Survex, Therion and GDAL make of the exported files, against
// PROJ's own program.

namespace lodeline {
namespace {

using test::kHalfCentimetre_m;
using test::Stations;
using test::SurveyPrograms;
using ::testing::HasSubstr;

struct WestGrid {
  const char* code;
  GeodeticPosition place;
  bool is_south_first;  ///< in the order of axes that cs2cs keeps
  const char* turned;   ///< the code of the grid counted to the east and north; empty without one
  const char* utm;      ///< the UTM zone, for Therion
};

const WestGrid kWestGrids[] = {
    {"EPSG:5513", {49.4, 16.7, 300.0}, true, "EPSG:5514", "EPSG:32633"},  // Krovak
    {"EPSG:2065", {49.4, 16.7, 300.0}, true, "EPSG:5221", "EPSG:32633"},  // Krovak, meridian of Ferro
    {"EPSG:2053", {-29.0, 29.5, 900.0}, false, "", "EPSG:32735"},         // South Africa, Lo29
    {"EPSG:22279", {-33.5, 19.2, 10.0}, false, "", "EPSG:32734"},         // Cape, Lo19
    {"EPSG:29371", {-17.5, 11.8, 20.0}, false, "", "EPSG:32732"}};        // Namibia, German metres

/// Pairs of numbers that cs2cs makes of others, in the order of the axes of both systems.
std::vector<Vec2> byCs2cs(const std::vector<Vec2>& points, const std::string& from, const std::string& to) {
  const test::TemporaryFolder folder;
  std::string lines;
  for (const Vec2& p : points) lines += fmt::format("{:.10f} {:.10f}\n", p.x(), p.y());
  writeOutput(folder.path() / "points", lines);
  const bool are_strings = from.starts_with('+');
  const std::string command = are_strings ? fmt::format("cs2cs -f %.10f {} +to {} points", from, to)
                                          : fmt::format("cs2cs -f %.10f {} {} points", from, to);
  std::istringstream output(test::runIn(folder.path(), command).output);
  std::vector<Vec2> found;
  for (std::string line; std::getline(output, line);) {
    Vec2 pair(NAN, NAN);
    std::istringstream(line) >> pair.x() >> pair.y();
    found.push_back(pair);
  }
  return found;
}

std::vector<Vec2> latitudesAndLongitudes(const DiveMap& map) {
  std::vector<Vec2> points;
  for (const SurveyStation& station : map.survey.stations) {
    const GeodeticPosition position = map.place->geodetic(station.position_ENU);
    points.emplace_back(position.latitude_deg, position.longitude_deg);
  }
  return points;
}

/// Eastings and northings of the stations on the grid in metres, by cs2cs.
std::vector<Vec2> eastNorthByCs2cs(const DiveMap& map, const WestGrid& grid) {
  std::vector<Vec2> points = byCs2cs(latitudesAndLongitudes(map), "EPSG:4326", grid.code);
  const double unit_m = map.place->gridDescription().metres_per_unit;
  for (Vec2& p : points) p = unit_m * (grid.is_south_first ? Vec2(-p.y(), -p.x()) : Vec2(-p));
  return points;
}

void expectAtPoints(const Stations& stations, const std::vector<Vec2>& expected) {
  ASSERT_EQ(stations.size(), expected.size());
  for (const auto& [index, position] : stations) {
    const Vec2 difference = position.head<2>() - expected[static_cast<size_t>(index)];
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), kHalfCentimetre_m) << "station " << index;
  }
}

/// Distances on the ground between positions in degrees, in metres.
double greatestDistance_m(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  if (a.size() != b.size()) return HUGE_VAL;
  constexpr double kMetresPerDegree = 111e3;
  double greatest_m = 0.0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double distance_m = kMetresPerDegree * (a[i] - b[i]).norm();
    greatest_m = distance_m <= greatest_m ? greatest_m : distance_m;  // takes what is no number
  }
  return greatest_m;
}

class WestGrids : public SurveyPrograms {
 protected:
  DiveMap mapOn(const WestGrid& grid) {
    DiveMapOptions options;
    options.entrance = grid.place;
    options.crs = grid.code;
    options.start_depth_m = 1.5;
    return write(test::windingDive(), options);
  }

  std::string fileText(const std::string& name) const {
    return test::runIn(folder_.path(), "cat " + name).output;
  }
};

TEST_F(WestGrids, SurvexHasTheCoordinatesOfCs2cs) {
  LODELINE_NEEDS_PROGRAM("cavern", "survex");
  LODELINE_NEEDS_PROGRAM("cs2cs", "proj-bin");
  for (const WestGrid& grid : kWestGrids) {
    SCOPED_TRACE(grid.code);
    const DiveMap map = mapOn(grid);
    expectAtPoints(cavern(map.name), eastNorthByCs2cs(map, grid));
    EXPECT_EQ(map.place->gridDescription().turned_code, grid.turned);
  }
}

// The name of the grid in the Survex file leads back to the place, with the datum of the grid.
TEST_F(WestGrids, SurvexNamesTheDatum) {
  LODELINE_NEEDS_PROGRAM("cs2cs", "proj-bin");
  for (const WestGrid& grid : kWestGrids) {
    SCOPED_TRACE(grid.code);
    const DiveMap map = mapOn(grid);
    std::string name = map.place->gridDescription().survex_name;
    EXPECT_THAT(fileText(map.name + ".svx"), HasSubstr("*cs " + name + "\n*cs out " + name + "\n"));
    const bool is_code = !name.starts_with("custom");
    if (!is_code) name = name.substr(8, name.size() - 9);
    std::vector<Vec2> found =
        byCs2cs(eastNorthByCs2cs(map, grid), name, is_code ? "EPSG:4326" : "+proj=longlat +datum=WGS84");
    if (!is_code) {
      for (Vec2& p : found) std::swap(p.x(), p.y());
    }
    // Of several shifts between two datums, cs2cs and the file may use another one.
    constexpr double kShiftsAgree_m = 3.0;
    EXPECT_LT(greatestDistance_m(found, latitudesAndLongitudes(map)), kShiftsAgree_m);
  }
}

TEST_F(WestGrids, TherionHasTheCoordinatesOfCs2cs) {
  LODELINE_NEEDS_PROGRAM("therion", "therion");
  LODELINE_NEEDS_PROGRAM("cs2cs", "proj-bin");
  for (const WestGrid& grid : kWestGrids) {
    SCOPED_TRACE(grid.code);
    const DiveMap map = mapOn(grid);
    const std::vector<Vec2> expected = byCs2cs(latitudesAndLongitudes(map), "EPSG:4326", grid.utm);
    expectAtPoints(therion(map.name), expected);
  }
}

TEST_F(WestGrids, GdalFindsThePlace) {
  if (!hasGdal()) GTEST_SKIP() << "built without GDAL: apt-get install libgdal-dev";
  LODELINE_NEEDS_PROGRAM("ogr2ogr", "gdal-bin");
  for (const WestGrid& grid : kWestGrids) {
    SCOPED_TRACE(grid.code);
    const DiveMap map = mapOn(grid);
    writeMap(map, std::nullopt, MapFormat::GeoPackage, folder_.path());
    const std::string command =
        "ogr2ogr -f CSV -lco GEOMETRY=AS_XY -t_srs EPSG:4326 /vsistdout/ " + map.name + ".gpkg stations";
    std::istringstream table(test::runIn(folder_.path(), command).output);
    std::vector<Vec2> found;
    std::string line;
    std::getline(table, line);
    EXPECT_THAT(line, HasSubstr("X,Y,name"));
    while (std::getline(table, line)) {
      Vec2 longitude_latitude(NAN, NAN);
      std::sscanf(line.c_str(), "%lf,%lf", &longitude_latitude.x(), &longitude_latitude.y());
      found.emplace_back(longitude_latitude.y(), longitude_latitude.x());
    }
    EXPECT_LT(greatestDistance_m(found, latitudesAndLongitudes(map)), 0.01);
  }
}

}  // namespace
}  // namespace lodeline
