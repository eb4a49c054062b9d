#include "lodeline/pipeline/page/background.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

namespace lodeline {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

class Background : public testing::Test {
 protected:
  std::string errorOf(const std::string& name, const std::string& at) const {
    try {
      readBackground(folder_.path() / name, at);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }
  TemporaryFolder folder_;
};

TEST_F(Background, PlacesLinesOfAGrid) {
  folder_.write("plan.geojson",
                R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":)"
                R"({"type":"LineString","coordinates":[[500010,3300000,-5],[500020,3300020]]}},)"
                R"({"type":"Feature","geometry":{"type":"Point","coordinates":[1,2]}},)"
                R"({"type":"Feature","geometry":null}]})");
  const auto lines = readBackground(folder_.path() / "plan.geojson", "500000,3300000")["lines"];
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0][1], nlohmann::ordered_json({20, 20}));
  // The grid's north lies 90 degrees clockwise from that of the page: its east points to the page's south.
  const auto turned = readBackground(folder_.path() / "plan.geojson", "500000,3300000,90")["lines"];
  EXPECT_NEAR(turned[0][0][0].get<double>(), 0.0, 1e-6);
  EXPECT_NEAR(turned[0][0][1].get<double>(), -10.0, 1e-6);
}

TEST_F(Background, PlacesLongitudesAndLatitudes) {
  folder_.write("line.geojson",
                R"({"type":"MultiLineString","coordinates":[[[-87.39,20.32],[-87.39,20.321]]]})");
  const auto lines = readBackground(folder_.path() / "line.geojson", "20.32,-87.39")["lines"];
  EXPECT_NEAR(lines[0][0][1].get<double>(), 0.0, 1e-6);
  EXPECT_NEAR(lines[0][1][1].get<double>(), 110.7, 0.1);  // m of a thousandth of a degree
  EXPECT_THAT(errorOf("line.geojson", "-87.39,20.32,5"), HasSubstr("LAT,LON"));
  EXPECT_THAT(errorOf("line.geojson", "500000,3300000"), HasSubstr("LAT,LON"));
}

TEST_F(Background, PlacesAnImageByItsWorldFile) {
  folder_.write("map.png", "any bytes");
  folder_.write("map.pgw", "0.5\n0\n0\n-0.5\n500100\r\n3300200\n");
  const auto image = readBackground(folder_.path() / "map.png", "500000,3300000")["image"];
  EXPECT_EQ(image["type"], "image/png");
  EXPECT_EQ(image["first_m"], nlohmann::ordered_json({100.0, 200.0}));
  EXPECT_EQ(image["column_m"], nlohmann::ordered_json({0.5, 0.0}));
  EXPECT_EQ(image["row_m"], nlohmann::ordered_json({0.0, -0.5}));
}

TEST_F(Background, NamesWhatIsWrong) {
  folder_.write("map.png", "x");
  EXPECT_THAT(errorOf("map.png", "1,2"), HasSubstr("no world file"));
  folder_.write("map.pgw", "0.5\n0\n0\n");
  EXPECT_THAT(errorOf("map.png", "1,2"), HasSubstr("six lines"));
  folder_.write("map.pgw", "0\n0\n0\n0\n1\n2\n");
  EXPECT_THAT(errorOf("map.png", "1,2"), HasSubstr("no area"));
  folder_.write("map.pgw", "1\n0\n0\n-1\n1\n2\n");
  EXPECT_THAT(errorOf("map.png", "1"), HasSubstr("E,N"));
  EXPECT_THAT(errorOf("map.png", "1,two"), HasSubstr("E,N"));
  EXPECT_THAT(errorOf("map.tif", "1,2"), HasSubstr("PNG or JPEG"));
  folder_.write("bad.geojson", "{");
  EXPECT_THAT(errorOf("bad.geojson", "1,2"), HasSubstr("no GeoJSON"));
  folder_.write("text.geojson", R"({"type":"LineString","coordinates":[["a","b"]]})");
  EXPECT_THAT(errorOf("text.geojson", "1,2"), HasSubstr("no GeoJSON"));
  folder_.write("points.geojson", R"({"type":"Point","coordinates":[1,2]})");
  EXPECT_THAT(errorOf("points.geojson", "1,2"), HasSubstr("no lines"));
}

}  // namespace
}  // namespace lodeline
