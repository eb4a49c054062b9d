#include "lodeline/output/survey/grid/map_grid.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/formats/test_outside_program.h"
#include "lodeline/output/survey/grid/georeference.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr GeodeticPosition kFlorida = {29.83, -82.60, 10.0};

std::string nameOf(const std::string& crs, const GeodeticPosition& place) {
  return MapGrid(crs, place).description().name;
}

TEST(MapGrid, IsNamedInTheUsualSpellings) {
  for (const char* name : {"UTM17N", "utm17n", "17N", "EPSG:32617", "epsg:32617", "auto", "AUTO"}) {
    EXPECT_EQ(nameOf(name, kFlorida), "UTM17N") << name;
  }
  EXPECT_EQ(nameOf("EPSG:32755", {-37.72, 142.9, 30.0}), "UTM55S");
  EXPECT_EQ(nameOf("auto", {60.4, 5.3, 0.0}), "UTM32N");  // the wider zone of southern Norway
  EXPECT_EQ(nameOf("epsg:6438", kFlorida), "EPSG:6438");
}

TEST(MapGrid, RefusesWhatIsNoGridWithAxesToEastAndNorth) {
  const auto expectRefusal = [](const char* crs, const char* says) {
    EXPECT_THAT([&] { MapGrid(crs, kFlorida); }, ThrowsMessage<UsageError>(HasSubstr(says))) << crs;
  };
  for (const char* crs :
       {"", "UTM", "UTM61N", "EPSG:", "EPSG:999999", "WGS84", "NaN", "+proj=utm +zone=17"}) {
    expectRefusal(crs, "UTM17N");
  }
  expectRefusal("EPSG:4326", "no projected grid");
  expectRefusal("EPSG:5773", "no projected grid");  // heights
  EXPECT_THROW(MapGrid("auto", {98.0, 0.0, 0.0}), UsageError);
}

TEST(MapGrid, KnowsTheSameGridInMetres) {
  const MapGridDescription florida = MapGrid("EPSG:6438", kFlorida).description();
  EXPECT_EQ(florida.unit, "US survey foot");
  EXPECT_NEAR(florida.metres_per_unit, 1200.0 / 3937.0, 1e-15);
  EXPECT_EQ(florida.survex_name, "EPSG:6437");
  EXPECT_EQ(florida.therion_name, "EPSG:6437");
  // A national foot; EPSG has this grid in feet only.
  const MapGridDescription gold_coast = MapGrid("EPSG:2136", {6.5, -1.0, 0.0}).description();
  EXPECT_THAT(gold_coast.survex_name, HasSubstr("custom \"+proj=tmerc"));
  EXPECT_THAT(gold_coast.survex_name, HasSubstr("+units=m"));
  EXPECT_FALSE(gold_coast.therion_name);
}

TEST(MapGrid, TurnsAxesToTheWestAndSouth) {
  const GeodeticPosition brno = {49.2, 16.6, 0.0};
  const MapGrid krovak("EPSG:5513", brno), east_north("EPSG:5514", brno);
  EXPECT_LT((krovak.project(49.2, 16.6) - east_north.project(49.2, 16.6)).norm(), 1e-6);
  EXPECT_NEAR(Georeference(brno, krovak).convergence_rad(), Georeference(brno, east_north).convergence_rad(),
              1e-9);
  const MapGridDescription description = krovak.description();
  EXPECT_TRUE(description.counts_west_and_south);
  EXPECT_EQ(description.survex_name, "EPSG:5514");
  EXPECT_EQ(description.gis_name, "EPSG:5514");
  EXPECT_FALSE(description.therion_name);
  // Without a counterpart in EPSG.
  const MapGridDescription cape = MapGrid("EPSG:22279", {-33.5, 19.2, 0.0}).description();
  EXPECT_THAT(cape.survex_name, HasSubstr("custom \"+proj=tmerc +lat_0=0 +lon_0=19 "));
  EXPECT_THAT(cape.survex_name, HasSubstr("+towgs84="));
  EXPECT_THAT(cape.gis_name, HasSubstr("Transverse Mercator"));
  EXPECT_THAT(cape.gis_name, HasSubstr("BASEGEOGCRS[\"Cape\""));
  EXPECT_EQ(cape.turned_code, "");
  EXPECT_FALSE(cape.therion_name);
  EXPECT_FALSE(east_north.description().counts_west_and_south);
  EXPECT_EQ(east_north.description().gis_name, "EPSG:5514");
}

TEST(MapGrid, SaysHowWellItIsTied) {
  EXPECT_EQ(MapGrid("auto", kFlorida).description().accuracy_m, 0.0);
  EXPECT_EQ(MapGrid("EPSG:6438", kFlorida).description().accuracy_m, 2.0);
  EXPECT_FALSE(MapGrid("EPSG:6438", kFlorida).description().lacks_grid_file);
  EXPECT_FALSE(MapGrid("EPSG:6441", kFlorida).description().is_outside_area);  // Florida North
  EXPECT_TRUE(MapGrid("EPSG:6438", kFlorida).description().is_outside_area);   // Florida East
}

TEST(MapGrid, IsNoGridWhereItsLengthsAreNotThoseOnTheGround) {
  const auto at = [](const char* crs, const GeodeticPosition& place) {
    return Georeference(place, MapGrid(crs, place));
  };
  EXPECT_THROW(at("UTM40N", kFlorida), UsageError);
  EXPECT_THROW(at("EPSG:3857", kFlorida), UsageError);  // the web's Mercator: 1.15 m a metre
  EXPECT_NEAR(at("EPSG:6372", {20.32, -87.39, 0.0}).scale(), 1.0, 0.01);
}

}  // namespace
}  // namespace lodeline
