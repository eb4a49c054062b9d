#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <GeographicLib/Geodesic.hpp>
#include <cmath>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/mapping/control/files/control_set.h"
#include "lodeline/mapping/control/test_control.h"

// Tests of tables of control points.

namespace lodeline {
namespace {

using test::errorOf;
using ::testing::HasSubstr;

class ControlTableTest : public ::testing::Test {
 protected:
  ControlSet read(const std::string& text) {
    return readControl(folder_.write("control.csv", text), options_, &diagnostics_);
  }
  std::string refusal(const std::string& text) {
    return errorOf([&] { read(text); });
  }

  test::TemporaryFolder folder_;
  Diagnostics diagnostics_;
  ControlReadOptions options_{.site = GeodeticPosition{20.5, -87.4, 8.0}, .grid_origin = {}};
};

TEST_F(ControlTableTest, ReadsSizesOfTags) {
  const ControlSet set = read("name,tag,size [cm]\nnear,3,15\n,4,\nnear,3,15\n");
  ASSERT_EQ(set.tag_sizes_m.size(), 1u);
  EXPECT_DOUBLE_EQ(set.tag_sizes_m.at(3), 0.15);
  EXPECT_THAT(refusal("name,tag,size [m]\nnear,3,0\n"), HasSubstr("not positive"));
  EXPECT_THAT(refusal("name,tag,size [m]\nnear,3,0.15\nnear,3,0.2\n"), HasSubstr("two sizes"));
  EXPECT_THAT(refusal("name,tag,size [m]\nmark,,0.15\n"), HasSubstr("is no tag"));
}

TEST_F(ControlTableTest, TurnsDegreesIntoMetresOfTheMap) {
  const ControlSet set = read(
      "name,kind,latitude,longitude,height [m],horizontal sigma [m],vertical sigma [m],time [s]\n"
      "entrance,gps,20.5,-87.4,8,2,4,12.5\n"
      "sink,gps,20.503,-87.396,11,,,\n");
  ASSERT_EQ(set.points.size(), 2u);
  EXPECT_LT(set.points[0].position->position.norm(), 1e-6);
  EXPECT_TRUE(set.points[0].position->covariance.isApprox(Mat3(Vec3(4, 4, 16).asDiagonal())));
  EXPECT_TRUE(set.points[1].position->covariance.isApprox(Mat3(Vec3(9, 9, 36).asDiagonal())));
  double distance_m = 0.0, azimuth_deg = 0.0, back_deg = 0.0;
  GeographicLib::Geodesic::WGS84().Inverse(20.5, -87.4, 20.503, -87.396, distance_m, azimuth_deg, back_deg);
  const Vec3 sink = set.points[1].position->position;
  EXPECT_NEAR(sink.head<2>().norm(), distance_m, 2e-3);
  EXPECT_NEAR(std::atan2(sink.x(), sink.y()) * 180.0 / M_PI, azimuth_deg, 2e-3);
  EXPECT_NEAR(sink.z(), 3.0 - distance_m * distance_m / (2.0 * 6.37e6), 2e-3);
  ASSERT_EQ(set.visits.size(), 1u);
  EXPECT_EQ(set.visits[0].point, "entrance");
  EXPECT_EQ(set.visits[0].since_start, Duration::fromSeconds(12.5));
  EXPECT_FALSE(set.visits[0].stamp);
}

TEST_F(ControlTableTest, ReadsGridsAndTheMapsOwnAxes) {
  options_.grid_origin = Vec3(450000, 2267000, 10);
  const ControlSet grid = read("station;easting;northing;altitude\nA1;450010,5;2266980;4\n");
  EXPECT_LT((grid.points[0].position->position - Vec3(10.5, -20, -6)).norm(), 1e-9);
  EXPECT_EQ(grid.points[0].kind, ControlKind::Station);
  const ControlSet local = read("name,east [ft],north [ft],up [ft],kind\nA1,10,20,-30,tie\n");
  EXPECT_LT((local.points[0].position->position - 0.3048 * Vec3(10, 20, -30)).norm(), 1e-9);
  EXPECT_EQ(local.points[0].kind, ControlKind::Tie);
}

TEST_F(ControlTableTest, JoinsRowsOfOnePoint) {
  const ControlSet set = read(
      "name,kind,east,north,up,time,dive,tag\n"
      "T,tie,1,2,3,,,\n"
      "T,tie,,,,1795255200000000000,dive 1,\n"
      "T,tie,1,2,3,1795255201.25,dive 2,\n"
      ",tag,,,,,,7\n");
  ASSERT_EQ(set.points.size(), 2u);
  EXPECT_EQ(set.points[0].position->position, Vec3(1, 2, 3));
  EXPECT_EQ(set.points[1].name, "tag 7");
  EXPECT_EQ(set.points[1].tag, 7);
  EXPECT_FALSE(set.points[1].position);
  ASSERT_EQ(set.visits.size(), 2u);
  EXPECT_EQ(set.visits[0].stamp, Time::fromNanoseconds(1795255200000000000));
  EXPECT_EQ(set.visits[1].stamp, Time::fromNanoseconds(1795255201250000000));
  EXPECT_EQ(set.visits[1].dive, "dive 2");
}

TEST_F(ControlTableTest, NamesWhatIsWrongWithARow) {
  EXPECT_THAT(refusal("a,b\n1,2\n"), HasSubstr("no header"));
  EXPECT_THAT(refusal("name,latitude,height\nA,1,2\n"), HasSubstr("latitude but no longitude"));
  const std::string head = "name,kind,latitude,longitude,height,tag,time,horizontal sigma\n";
  EXPECT_THAT(refusal(head + "A,gps,20.5,-87.4,8,,,\nB,gsp,20.5,-87.4,8,,,\n"),
              HasSubstr("control.csv:3: the kind 'gsp' is none of"));
  EXPECT_THAT(refusal(head + "A,gps,20.5,,8,,,\n"), HasSubstr("control.csv:2: a coordinate is missing"));
  EXPECT_THAT(refusal(head + "A,gps,20.5,-87.4,,,,\n"), HasSubstr("control.csv:2: the height is missing"));
  EXPECT_THAT(refusal(head + "A,gps,,,,,,\n"), HasSubstr("'A' has no position"));
  EXPECT_THAT(refusal(head + "A,gps,20.5,x,8,,,\n"), HasSubstr("'x' in the column 'longitude' is no number"));
  EXPECT_THAT(refusal(head + "A,gps,120.5,-87.4,8,,,\n"), HasSubstr("no latitude"));
  EXPECT_THAT(refusal(head + "A,gps,-87.4,20.5,8,,,\n"), HasSubstr("order of latitude and longitude"));
  EXPECT_THAT(refusal(head + ",gps,20.5,-87.4,8,,,\n"), HasSubstr("control.csv:2: the name is missing"));
  EXPECT_THAT(refusal(head + "A,tag,,,,,,\n"), HasSubstr("lacks its number"));
  EXPECT_THAT(refusal(head + "A,tag,,,,1.5,,\n"), HasSubstr("no number of an AprilTag"));
  EXPECT_THAT(refusal(head + "A,gps,20.5,-87.4,8,,-3,\n"), HasSubstr("the time is negative"));
  EXPECT_THAT(refusal(head + "A,gps,20.5,-87.4,8,,,0\n"), HasSubstr("a sigma is not positive"));
  EXPECT_THAT(refusal(head + "A,gps,20.5,-87.4,8,,,\nA,gps,20.5,-87.41,8,,,\n"),
              HasSubstr("control.csv:3: the position of 'A' differs from that at"));
  EXPECT_THAT(refusal("name,easting,northing,altitude\nA,450000,2267000,4\n"),
              HasSubstr("control.csv:2: is 2311 km from the origin of the map"));
  options_.site.reset();
  EXPECT_THAT(refusal(head + "A,gps,20.5,-87.4,8,,,\n"), HasSubstr("--site"));
  options_.gps.vertical_m = 0.0;
  EXPECT_THAT(refusal(head), HasSubstr("sigmas of control points must be positive"));
}

}  // namespace
}  // namespace lodeline
