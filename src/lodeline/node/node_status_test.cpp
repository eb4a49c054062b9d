#include "lodeline_ros/node_status.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lodeline {
namespace {

using message::DiagnosticStatus;
using ::testing::HasSubstr;

std::string valueOf(const DiagnosticStatus& status, const std::string& key) {
  for (const message::KeyValue& pair : status.values) {
    if (pair.key == key) return pair.value;
  }
  return "no value of key " + key;
}

FrameEstimate tracking() {
  FrameEstimate estimate;
  estimate.status = Status::Tracking;
  auto& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  magnetometer.status = MagnetometerStatus::Used;
  magnetometer.heading_sigma_rad = 0.01;
  return estimate;
}

TEST(NodeStatus, NamesTheSensorsThatItWaitsFor) {
  const message::DiagnosticArray array = NodeStatus().message(ros::Time(), {"IMU", "cam1"});
  ASSERT_EQ(array.status.size(), 2U);
  EXPECT_EQ(array.status[0].level, DiagnosticStatus::WARN);
  EXPECT_EQ(array.status[0].message, "waiting for messages of IMU, cam1");
}

TEST(NodeStatus, IsGoodWhileItTracks) {
  NodeStatus node;
  for (int i = 0; i < 10; ++i) node.add(tracking(), 0.01, 0.05, 3);
  node.setFindings(
      {{Severity::Notice, "bag_topic", "no harm", 1}, {Severity::Warning, "imu_gap", "a gap", 2}});
  const message::DiagnosticArray array = node.message(ros::Time(), {});
  const DiagnosticStatus& estimator = array.status[0];
  EXPECT_EQ(estimator.level, DiagnosticStatus::OK);
  EXPECT_EQ(estimator.message, "tracking");
  EXPECT_EQ(valueOf(estimator, "frames"), "10");
  EXPECT_EQ(valueOf(estimator, "ratio to real time"), "5.0");
  EXPECT_EQ(valueOf(estimator, "images waiting"), "3");
  EXPECT_EQ(valueOf(estimator, "imu_gap"), "2 x, first: a gap");
  EXPECT_THAT(valueOf(estimator, "bag_topic"), HasSubstr("no value"));
  EXPECT_EQ(array.status[1].level, DiagnosticStatus::OK);
  EXPECT_EQ(valueOf(array.status[1], "heading sigma [deg]"), "0.57");
}

TEST(NodeStatus, WarnsOfWhatHolds) {
  NodeStatus node;
  FrameEstimate estimate = tracking();
  estimate.status = Status::Waiting;
  estimate.waiting_for = "parallax 12 of 20 px";
  estimate.sensors.of<MagnetometerEstimate>().status = MagnetometerStatus::Norm;
  node.add(estimate, 0.01, 0.05, 0);
  const message::DiagnosticArray array = node.message(ros::Time(), {});
  EXPECT_EQ(array.status[0].level, DiagnosticStatus::WARN);
  EXPECT_EQ(array.status[0].message, "waiting for parallax 12 of 20 px");
  EXPECT_EQ(array.status[1].level, DiagnosticStatus::WARN);
}

}  // namespace
}  // namespace lodeline
