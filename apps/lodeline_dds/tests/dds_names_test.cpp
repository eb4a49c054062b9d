#include "apps/lodeline_dds/transport/dds_names.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "lodeline/diagnostics.h"

namespace lodeline::dds {
namespace {

TEST(DdsNames, AreThoseOfRos2) {
  EXPECT_EQ(ddsTopic("/camera/left/image_raw"), "rt/camera/left/image_raw");
  EXPECT_EQ(ddsType("sensor_msgs/Imu"), "sensor_msgs::msg::dds_::Imu_");
  EXPECT_EQ(rosType("sensor_msgs::msg::dds_::Imu_"), "sensor_msgs/Imu");
  EXPECT_FALSE(rosType("sensor_msgs::srv::dds_::SetCameraInfo_Request_"));
  EXPECT_FALSE(rosType("Imu"));
}

TEST(DdsNames, StandInTheirNamespace) {
  EXPECT_EQ(fullName("odometry", "/lodeline"), "/lodeline/odometry");
  EXPECT_EQ(fullName("odometry", "lodeline"), "/lodeline/odometry");
  EXPECT_EQ(fullName("odometry", "/"), "/odometry");
  EXPECT_EQ(fullName("odometry", ""), "/odometry");
  EXPECT_EQ(fullName("odometry", "/dive/a_2"), "/dive/a_2/odometry");
  EXPECT_EQ(fullName("/tf", "/lodeline"), "/tf");
}

TEST(DdsNames, RefuseWhatRos2DoesNotAccept) {
  for (const char* bad : {"/a b", "/1st", "/a//b", "/a/", "/a-b", "/"}) {
    EXPECT_THROW(fullName(bad, "/"), UsageError) << bad;
  }
  EXPECT_THROW(fullName("odometry", "/bad space"), UsageError);
}

TEST(DdsNames, DomainIsThatOfTheEnvironment) {
  unsetenv("ROS_DOMAIN_ID");
  EXPECT_EQ(domainOfEnvironment(), 0);
  setenv("ROS_DOMAIN_ID", "42", 1);
  EXPECT_EQ(domainOfEnvironment(), 42);
  for (const char* bad : {"-1", "233", "4x", "x"}) {
    setenv("ROS_DOMAIN_ID", bad, 1);
    EXPECT_THROW(domainOfEnvironment(), UsageError) << bad;
  }
  unsetenv("ROS_DOMAIN_ID");
}

}  // namespace
}  // namespace lodeline::dds
