#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/grid/place_text.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

void expectAt(const std::string& text, double latitude_deg, double longitude_deg, double height_m) {
  SCOPED_TRACE(text);
  StatedPlace place;
  ASSERT_NO_THROW(place = parsePlace(text, "--entrance"));
  EXPECT_NEAR(place.position.latitude_deg, latitude_deg, 1e-8);
  EXPECT_NEAR(place.position.longitude_deg, longitude_deg, 1e-8);
  EXPECT_NEAR(place.position.height_m, height_m, 1e-9);
}

TEST(PlaceText, ReadsTheUsualNotationsOfDegrees) {
  for (const char* text :
       {"20.32,-87.39,5", "20.32 -87.39 5", "20.32; -87.39; 5", "20.32, -87.39, 5 m", "20.32N 87.39W 5",
        "20°19'12\"N, 87°23'24\"W, 5", "20° 19′ 12″ N 87° 23′ 24″ W 5 m", "20°19'12''N 87°23'24''W 5",
        "20 19 12 N 87 23 24 W 5", "20 19.2 N, 87 23.4 W, 5", "N 20 19.2 W 87 23.4 5",
        "N20°19.2' W87°23.4' 5m", "20d19m12sN 87d23m24sW 5", "20:19:12N 87:23:24W 5", "20°19.2' -87°23.4' 5",
        "87°23.4'W 20°19.2'N 5", "20 19.2 north 87 23.4 west 5", "W87 23 24, N20 19 12, 5"}) {
    expectAt(text, 20.32, -87.39, 5.0);
  }
  expectAt("20 19 12 S 87 23 24 E -3.5", -20.32, 87.39, -3.5);
  expectAt("20.32s 87.39e 33 ft", -20.32, 87.39, 10.0584);
  expectAt("-0°30' 0°15' 0", -0.5, 0.25, 0.0);
}

TEST(PlaceText, KnowsWhetherAHeightIsStated) {
  EXPECT_TRUE(parsePlace("20.32,-87.39,0", "").has_height);
  EXPECT_FALSE(parsePlace("20.32,-87.39", "").has_height);
  EXPECT_FALSE(parsePlace("16N 450000 2246000", "").has_height);
}

// Reference values: echo "450000 2246000" | cs2cs -f %.9f EPSG:32616 EPSG:4326, and the like.
TEST(PlaceText, ReadsUtmAndGrids) {
  for (const char* text :
       {"16Q 450000 2246000 5", "16N 450000 2246000 5", "UTM16N,450000,2246000,5",
        "16 north 450000 2246000 5 m", "EPSG:32616 450000 2246000 5", "epsg:32616, 450000, 2246000, 5"}) {
    expectAt(text, 20.311273660, -87.478931786, 5.0);
  }
  expectAt("EPSG:6438 488233.0 660000.0 10", 26.148514078, -81.511932310, 10.0);  // feet
  expectAt("EPSG:2193 1557949.159 5461122.562 7", -40.999999999, 172.500000000, 7.0);
  EXPECT_EQ(parsePlace("EPSG:6438 488233 660000", "").grid, "EPSG:6438");
  // Another datum in degrees: NAD27 differs from WGS 84 by some metres.
  const GeodeticPosition nad27 = parsePlace("EPSG:4267 29.83 -82.6 10", "").position;
  EXPECT_GT(std::abs(nad27.longitude_deg + 82.6), 1e-5);
  EXPECT_LT(std::abs(nad27.longitude_deg + 82.6), 1e-3);
}

TEST(PlaceText, RefusesWhatMayBeAnotherPlace) {
  const auto expectRefusal = [](const char* text, const char* says) {
    EXPECT_THAT([&] { parsePlace(text, "--entrance"); }, ThrowsMessage<UsageError>(HasSubstr(says))) << text;
  };
  for (const char* text :
       {"", "here", "20.32", "20.32,-87.39,5,7", "20 19 12 87 23 24", "20°61'N 87°23'W", "-20°19'N 87°23'W",
        "20N 87N", "20E 87W", "20.32,nan,5", "20°19'12\"N", "20N 87W 5 miles", "1e400,2,3"}) {
    expectRefusal(text, "a place is wanted");
  }
  expectRefusal("17S 450000 3800000 5", "17 south");  // band S, or the southern hemisphere
  expectRefusal("16R 450000 2246000 5", "in band Q, not R");
  expectRefusal("61N 450000 2246000 5", "1 to 60");
  expectRefusal("16I 450000 2246000 5", "no band");
  expectRefusal("EPSG:999999 1 2 3", "unknown");
  expectRefusal("EPSG:5773 1 2 3", "no grid");
  expectRefusal("EPSG:6372 1", "two or three");
  expectRefusal("EPSG:2193 1e12 1e12", "no place");
  EXPECT_NO_THROW(parsePlace("17 south 450000 3800000 5", ""));
  EXPECT_NO_THROW(parsePlace("55S 450000 5823000 5", ""));
}

}  // namespace
}  // namespace lodeline
