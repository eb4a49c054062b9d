#include "lodeline/io/tables/column_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lodeline {
namespace {

using ::testing::ElementsAre;

TEST(ColumnName, FallsIntoWordsWithoutItsUnit) {
  EXPECT_THAT(ColumnName("GyrX").words, ElementsAre("gyr", "x"));
  EXPECT_THAT(ColumnName("Magnetic field x (\u00b5T)").words, ElementsAre("magnetic", "field", "x"));
  EXPECT_THAT(ColumnName("p_RS_R_x [m]").words, ElementsAre("p", "rs", "r", "x"));
  EXPECT_THAT(ColumnName("field.pose.position.x").words, ElementsAre("field", "pose", "position", "x"));
  EXPECT_THAT(ColumnName("gyro_rad[0]").words, ElementsAre("gyro", "rad", "0"));
  EXPECT_THAT(ColumnName("motionRotationRateX(rad/s)").words, ElementsAre("motion", "rotation", "rate", "x"));
  EXPECT_THAT(ColumnName("X Mag [x8006]").words, ElementsAre("x", "mag"));
  EXPECT_THAT(ColumnName("TimeUS").words, ElementsAre("time", "us"));
  EXPECT_THAT(ColumnName("Acc\u00e9l\u00e9ration x").words, ElementsAre("acceleration", "x"));
  EXPECT_THAT(ColumnName("").words, ElementsAre());
}

TEST(ColumnName, HasItsUnit) {
  EXPECT_EQ(ColumnName("wx [deg/s]").unit, "deg/s");
  EXPECT_EQ(ColumnName("ax (m/s^2)").unit, "m/s^2");
  EXPECT_EQ(ColumnName("Time since start in ms ").unit, "ms");
  EXPECT_EQ(ColumnName("X Mag [x8006]").unit, "");
  EXPECT_EQ(ColumnName("gyro_rad[0]").unit, "");
  EXPECT_EQ(ColumnName("q_RS_w []").unit, "");
  EXPECT_EQ(ColumnName("field_nT").suffixes.front(), "nT");
}

}  // namespace
}  // namespace lodeline
