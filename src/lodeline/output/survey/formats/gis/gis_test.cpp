#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/output/survey/formats/map_files.h"
#include "lodeline/output/survey/formats/test_outside_program.h"
#include "lodeline/output/survey/map/test_dive.h"

// Tests of GeoJSON, KML and GPX: their content, and that GDAL reads them.

namespace lodeline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

DiveMap windingMap() {
  DiveMapOptions options;
  options.title = "A <deep> & \"long\" dive";
  options.entrance = test::kDevilsEye;
  options.start_depth_m = 2.0;
  options.geoid_height_m = -27.5;
  Diagnostics diagnostics;
  return makeDiveMap(test::windingDive(), options, {}, &diagnostics);
}

double signedArea(const nlohmann::json& ring) {
  double area = 0.0;
  for (size_t i = 0; i + 1 < ring.size(); ++i) {
    const auto x = [&](size_t k) { return (ring[k][0].get<double>() - ring[0][0].get<double>()) * 1e5; };
    const auto y = [&](size_t k) { return (ring[k][1].get<double>() - ring[0][1].get<double>()) * 1e5; };
    area += 0.5 * (x(i) * y(i + 1) - x(i + 1) * y(i));
  }
  return area;
}

TEST(GeoJson, FollowsRfc7946) {
  const DiveMap map = windingMap();
  const nlohmann::json json = nlohmann::json::parse(geojsonText(map));
  EXPECT_EQ(json["type"], "FeatureCollection");
  EXPECT_FALSE(json.contains("crs"));
  const nlohmann::json& line = json["features"][0]["geometry"];
  ASSERT_EQ(line["type"], "LineString");
  ASSERT_EQ(line["coordinates"].size(), map.survey.stations.size());
  const nlohmann::json& first = line["coordinates"][0];
  EXPECT_NEAR(first[0].get<double>(), -82.60, 1e-9);  // longitude comes first
  EXPECT_NEAR(first[1].get<double>(), 29.83, 1e-9);
  EXPECT_NEAR(first[2].get<double>(), 10.0 - 2.0 - 27.5, 1e-4);  // above the ellipsoid
}

TEST(GeoJson, OutlinesThePassageCounterClockwise) {
  const nlohmann::json json = nlohmann::json::parse(geojsonText(windingMap()));
  const nlohmann::json& plan = json["features"][1]["geometry"];
  ASSERT_EQ(plan["type"], "MultiPolygon");
  EXPECT_GT(plan["coordinates"].size(), 10U);
  for (const nlohmann::json& polygon : plan["coordinates"]) {
    ASSERT_EQ(polygon.size(), 1U);
    EXPECT_EQ(polygon[0].size(), 5U);
    EXPECT_EQ(polygon[0].front(), polygon[0].back());
    EXPECT_GT(signedArea(polygon[0]), 0.0);
  }
}

TEST(Kml, HasTheLineOnTheGroundAndAtItsHeight) {
  const std::string text = kmlText(windingMap());
  EXPECT_THAT(text, HasSubstr("<altitudeMode>clampToGround</altitudeMode>"));
  EXPECT_THAT(text, HasSubstr("<altitudeMode>absolute</altitudeMode>"));
  EXPECT_THAT(text, HasSubstr("-82.600000000,29.830000000,8.000"));
  EXPECT_THAT(text, HasSubstr("depth 2.0 m"));
  EXPECT_THAT(text, HasSubstr("A &lt;deep&gt; &amp; &quot;long&quot; dive"));
}

TEST(Gpx, HasTrackAndStationsWithTheirTimes) {
  const std::string text = gpxText(windingMap());
  EXPECT_THAT(text, HasSubstr("<trkpt lat=\"29.830000000\" lon=\"-82.600000000\"><ele>8.000</ele>"
                              "<time>2026-11-21T10:00:00.000Z</time></trkpt>"));
  // The schema requires waypoints before tracks.
  EXPECT_LT(text.find("<wpt "), text.find("<trk>"));
  RunFolder run = test::windingDive();
  for (StampedPose& pose : run.trajectory.poses) {
    pose.time = Time::fromNanoseconds(pose.time.nanoseconds() - 1795255000000000000);
  }
  DiveMapOptions options;
  options.entrance = test::kDevilsEye;
  Diagnostics diagnostics;
  EXPECT_THAT(gpxText(makeDiveMap(run, options, {}, &diagnostics)), Not(HasSubstr("<time>")));
}

TEST(Gis, NeedsAPlace) {
  Diagnostics diagnostics;
  const DiveMap map = makeDiveMap(test::windingDive(), {}, {}, &diagnostics);
  for (MapFormat format : {MapFormat::GeoJson, MapFormat::Kml, MapFormat::Gpx}) {
    EXPECT_THROW(writeMap(map, std::nullopt, format, "/nowhere"), UsageError);
  }
}

TEST(Gis, IsReadByGdal) {
  LODELINE_NEEDS_PROGRAM("ogrinfo", "gdal-bin");
  const test::TemporaryFolder folder;
  for (MapFormat format : {MapFormat::GeoJson, MapFormat::Kml, MapFormat::Gpx}) {
    const std::string file = writeMap(windingMap(), std::nullopt, format, folder.path()).front().filename();
    const test::OutsideRun run = test::runIn(folder.path(), "ogrinfo -ro -al -geom=SUMMARY " + file);
    EXPECT_EQ(run.exit_code, 0) << run.output;
    EXPECT_THAT(run.output, Not(HasSubstr("Warning"))) << file;
    EXPECT_THAT(run.output, HasSubstr("WGS 84")) << file;
    EXPECT_THAT(run.output, HasSubstr("Extent: (-82.600")) << file;
  }
}

/// The same dive with missing and invalid covariances.
DiveMap unsureMap() {
  RunFolder run = test::windingDive();
  run.uncertainties.resize(300);
  run.uncertainties[100].covariance(0, 0) = -1.0;
  DiveMapOptions options;
  options.entrance = test::kDevilsEye;
  options.crs = "EPSG:6438";
  Diagnostics diagnostics;
  return makeDiveMap(run, options, {}, &diagnostics);
}

TEST(Gis, FindsTheColumnsOfTheTables) {
  LODELINE_NEEDS_PROGRAM("ogrinfo", "gdal-bin");
  const test::TemporaryFolder folder;
  const DiveMap map = unsureMap();
  writeMap(map, std::nullopt, MapFormat::Csv, folder.path());
  const auto read = [&](const std::string& file) {
    return test::runIn(folder.path(), "ogrinfo -ro -al -so -oo AUTODETECT_TYPE=YES " + map.name + file)
        .output;
  };
  const std::string stations = read("_stations.csv"), poses = read("_poses.csv");
  EXPECT_THAT(stations, HasSubstr(fmt::format("Feature Count: {}\n", map.survey.stations.size())));
  EXPECT_THAT(stations, HasSubstr("station: Integer"));
  EXPECT_THAT(stations, HasSubstr("latitude [deg]: Real"));
  EXPECT_THAT(stations, HasSubstr("grid_easting [ftUS]: Real"));
  EXPECT_THAT(poses, HasSubstr(fmt::format("Feature Count: {}\n", map.trajectory.poses.size())));
  EXPECT_THAT(poses, HasSubstr("timestamp [ns]: Integer64"));
  EXPECT_THAT(poses, HasSubstr("sigma_east [m]: Real"));
  const std::string text = posesCsv(map);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_EQ(text.find('#'), std::string::npos);
}

TEST(Gis, IsWellFormedXml) {
  LODELINE_NEEDS_PROGRAM("xmllint", "libxml2-utils");
  const test::TemporaryFolder folder;
  for (MapFormat format : {MapFormat::Kml, MapFormat::Gpx}) {
    const std::string file = writeMap(windingMap(), std::nullopt, format, folder.path()).front().filename();
    const test::OutsideRun run = test::runIn(folder.path(), "xmllint --noout " + file);
    EXPECT_EQ(run.exit_code, 0) << run.output;
  }
}

// GDAL's own programs read both files; coordinates are those of the grid in its unit.
TEST(GeoPackage, LiesOnTheGridInItsOwnUnit) {
  if (!hasGdal()) GTEST_SKIP() << "built without GDAL: apt-get install libgdal-dev";
  LODELINE_NEEDS_PROGRAM("ogrinfo", "gdal-bin");
  DiveMapOptions options;
  options.entrance = test::kDevilsEye;
  options.crs = "EPSG:6438";  // US feet
  options.vertical_datum = "EPSG:5703";
  Diagnostics diagnostics;
  const DiveMap map = makeDiveMap(test::windingDive(), options, {}, &diagnostics);
  const test::TemporaryFolder folder;
  writeMap(map, std::nullopt, MapFormat::GeoPackage, folder.path());
  writeMap(map, std::nullopt, MapFormat::Dxf, folder.path());
  const auto at = [&](size_t i) {
    const Vec3 grid = map.place->grid(map.survey.stations[i].position_ENU);
    const double unit_m = map.place->gridDescription().metres_per_unit;
    return Vec3(grid.x() / unit_m, grid.y() / unit_m, grid.z());
  };
  const std::string stations =
      test::runIn(folder.path(), "ogrinfo -al " + map.name + ".gpkg stations").output;
  EXPECT_THAT(stations, HasSubstr("Feature Count: " + std::to_string(map.survey.stations.size())));
  EXPECT_THAT(stations, HasSubstr("NAD83(2011) / Florida East (ftUS)"));
  double x = 0.0, y = 0.0, z = 0.0;
  ASSERT_EQ(std::sscanf(stations.c_str() + stations.find("POINT Z ("), "POINT Z (%lf %lf %lf)", &x, &y, &z),
            3);
  EXPECT_LT((Vec3(x, y, z) - at(0)).norm(), 1e-6);
  const std::string line = test::runIn(folder.path(), "ogrinfo -al " + map.name + ".gpkg line").output;
  EXPECT_THAT(line, HasSubstr("vertical_datum (String) = NAVD88 height (EPSG:5703)"));
  const std::string dxf = test::runIn(folder.path(), "ogrinfo -al " + map.name + ".dxf").output;
  for (const char* layer : {"LINE", "STATIONS", "NAMES", "PASSAGE"})
    EXPECT_THAT(dxf, HasSubstr(std::string("Layer (String) = ") + layer)) << layer;
  const size_t begin = dxf.find("LINESTRING Z (");
  ASSERT_NE(begin, std::string::npos);
  ASSERT_EQ(std::sscanf(dxf.c_str() + begin, "LINESTRING Z (%lf %lf %lf", &x, &y, &z), 3);
  EXPECT_LT((Vec3(x, y, z) - at(0)).norm(), 1e-3);
}

TEST(VerticalDatum, IsStatedOrRefused) {
  const GeodeticPosition place = test::kDevilsEye;
  EXPECT_EQ(verticalDatum("", place).name, "");
  EXPECT_EQ(verticalDatum("ellipsoid", place).geoid_height_m, 0.0);
  EXPECT_EQ(verticalDatum("EPSG:5703", place).name, "NAVD88 height (EPSG:5703)");
  EXPECT_EQ(verticalDatum("NAVD88 height", place).name, "NAVD88 height (EPSG:5703)");
  EXPECT_THROW(verticalDatum("EPSG:32617", place), UsageError);
  EXPECT_THROW(verticalDatum("the sea", place), UsageError);
  DiveMapOptions options;
  options.entrance = place;
  options.vertical_datum = "EPSG:5703";
  options.geoid_height_m = -27.5;
  Diagnostics diagnostics;
  const DiveMap map = makeDiveMap(test::windingDive(), options, {}, &diagnostics);
  EXPECT_EQ(diagnostics.count("geoid_height_unknown"), 0);
  EXPECT_THAT(map.notes,
              ::testing::Contains("heights: in metres above NAVD88 height (EPSG:5703); it lies -27.50 m "
                                  "above the WGS 84 ellipsoid"));
}

}  // namespace
}  // namespace lodeline
