#include "lodeline/io/tables/pose_columns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lodeline {
namespace {

using ::testing::ElementsAre;

std::optional<PoseColumns> poseOf(std::initializer_list<const char*> names) {
  std::vector<ColumnName> columns;
  for (const char* name : names) columns.emplace_back(name);
  return findPoseColumns(columns);
}

TEST(PoseColumns, AreFoundByTheNamesOfManyPrograms) {
  const auto okvis = poseOf({"timestamp", "p_WS_W_x", "p_WS_W_y", "p_WS_W_z", "q_WS_x", "q_WS_y", "q_WS_z",
                             "q_WS_w", "v_WS_W_x", "v_WS_W_y", "v_WS_W_z", "b_g_x", "b_g_y", "b_g_z"});
  ASSERT_TRUE(okvis);
  EXPECT_THAT(okvis->position, ElementsAre(1, 2, 3));
  EXPECT_THAT(okvis->rotation, ElementsAre(4, 5, 6, 7));
  const auto euroc = poseOf({"timestamp", "p_RS_R_x [m]", "p_RS_R_y [m]", "p_RS_R_z [m]", "q_RS_w []",
                             "q_RS_x []", "q_RS_y []", "q_RS_z []", "v_RS_R_x [m s^-1]"});
  ASSERT_TRUE(euroc);
  EXPECT_THAT(euroc->rotation, ElementsAre(5, 6, 7, 4));
  const auto ros =
      poseOf({"time", "field.header.seq", "field.pose.pose.position.x", "field.pose.pose.position.y",
              "field.pose.pose.position.z", "field.pose.pose.orientation.x", "field.pose.pose.orientation.y",
              "field.pose.pose.orientation.z", "field.pose.pose.orientation.w", "field.pose.covariance0",
              "field.twist.twist.linear.x"});
  ASSERT_TRUE(ros);
  EXPECT_THAT(ros->position, ElementsAre(2, 3, 4));
  EXPECT_THAT(ros->rotation, ElementsAre(5, 6, 7, 8));
  const auto kimera = poseOf({"timestamp", "x", "y", "z", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "bgx"});
  ASSERT_TRUE(kimera);
  EXPECT_THAT(kimera->position, ElementsAre(1, 2, 3));
  EXPECT_THAT(kimera->rotation, ElementsAre(5, 6, 7, 4));
  const auto maplab = poseOf({"timestamp [ns]", "position x [m]", "position y [m]", "position z [m]",
                              "quaternion x", "quaternion y", "quaternion z", "quaternion w"});
  ASSERT_TRUE(maplab);
  EXPECT_THAT(maplab->rotation, ElementsAre(4, 5, 6, 7));
  const auto px4 = poseOf({"timestamp", "x", "y", "z", "q[0]", "q[1]", "q[2]", "q[3]"});
  ASSERT_TRUE(px4);
  EXPECT_THAT(px4->rotation, ElementsAre(5, 6, 7, 4));
  EXPECT_TRUE(px4->w_is_assumed_first);
}

TEST(PoseColumns, MayHaveFramesBeforeTheAxis) {
  const auto maplab =
      poseOf({"timestamp [ns]", "vertex-id", "mission-id", "p_G_Ix [m]", "p_G_Iy [m]", "p_G_Iz [m]",
              "q_G_Iw [-]", "q_G_Ix [-]", "q_G_Iy [-]", "q_G_Iz [-]", "v_G_Ix [m/s]", "b_Ax [m/s^2]"});
  ASSERT_TRUE(maplab);
  EXPECT_THAT(maplab->position, ElementsAre(3, 4, 5));
  EXPECT_THAT(maplab->rotation, ElementsAre(7, 8, 9, 6));
}

TEST(PoseColumns, StateTheUnitOfThePosition) {
  const auto unitOf = [](const char* x) {
    const auto pose = poseOf({"t", x, "y", "z", "qx", "qy", "qz", "qw"});
    return pose ? std::pair(pose->position_to_m, pose->unknown_unit) : std::pair(0.0, std::string("none"));
  };
  EXPECT_EQ(unitOf("x [mm]"), std::pair(1e-3, std::string()));
  EXPECT_EQ(unitOf("x (ft)"), std::pair(0.3048, std::string()));
  EXPECT_EQ(unitOf("x [-]"), std::pair(1.0, std::string()));
  EXPECT_EQ(unitOf("x"), std::pair(1.0, std::string()));
  EXPECT_EQ(unitOf("x [deg]"), std::pair(1.0, std::string("deg")));
}

TEST(PoseColumns, NeedPositionAndQuaternion) {
  EXPECT_FALSE(poseOf({"time", "x", "y", "z"}));
  EXPECT_FALSE(poseOf({"time", "x", "y", "z", "qx", "qy", "qz"}));
  EXPECT_FALSE(poseOf({"time", "qx", "qy", "qz", "qw", "vx", "vy", "vz"}));
  EXPECT_FALSE(poseOf({}));
}

}  // namespace
}  // namespace lodeline
