#include "lodeline/node/node_status.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lodeline {
namespace {

using ::testing::HasSubstr;

std::string valueOf(const DiagnosticStatus& status, const std::string& key) {
  for (const auto& [name, value] : status.values) {
    if (name == key) return value;
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
  const auto statuses = NodeStatus().statuses({"IMU", "cam1"}, {});
  ASSERT_EQ(statuses.size(), 3U);
  EXPECT_EQ(statuses[0].level, DiagnosticStatus::kWarn);
  EXPECT_EQ(statuses[0].message, "waiting for messages of IMU, cam1");
}

TEST(NodeStatus, IsGoodWhileItTracks) {
  NodeStatus node;
  for (int i = 0; i < 10; ++i) node.add(tracking(), 0.01, 0.05, 3);
  node.setFindings(
      {{Severity::Notice, "bag_topic", "no harm", 1}, {Severity::Warning, "imu_gap", "a gap", 2}});
  const auto statuses = node.statuses({}, {});
  const DiagnosticStatus& estimator = statuses[0];
  EXPECT_EQ(estimator.level, DiagnosticStatus::kOk);
  EXPECT_EQ(estimator.message, "tracking");
  EXPECT_EQ(valueOf(estimator, "frames"), "10");
  EXPECT_EQ(valueOf(estimator, "ratio to real time"), "5.0");
  EXPECT_EQ(valueOf(estimator, "images waiting"), "3");
  EXPECT_EQ(valueOf(estimator, "imu_gap"), "2 x, first: a gap");
  EXPECT_THAT(valueOf(estimator, "bag_topic"), HasSubstr("no value"));
  EXPECT_EQ(statuses[1].level, DiagnosticStatus::kOk);
  EXPECT_EQ(valueOf(statuses[1], "heading sigma [deg]"), "0.57");
}

TEST(NodeStatus, WarnsOfWhatHolds) {
  NodeStatus node;
  FrameEstimate estimate = tracking();
  estimate.status = Status::Waiting;
  estimate.waiting_for = "parallax 12 of 20 px";
  estimate.sensors.of<MagnetometerEstimate>().status = MagnetometerStatus::Norm;
  node.add(estimate, 0.01, 0.05, 0);
  const auto statuses = node.statuses({}, {});
  EXPECT_EQ(statuses[0].level, DiagnosticStatus::kWarn);
  EXPECT_EQ(statuses[0].message, "waiting for parallax 12 of 20 px");
  EXPECT_EQ(statuses[1].level, DiagnosticStatus::kWarn);
}

TEST(NodeStatus, TellsLossesOnceAndKeepsTheirCount) {
  NodeStatus node;
  SensorTraffic imu{"imu0", "/imu", 1000, 0, 0, ""};
  EXPECT_EQ(node.statuses({}, {imu})[2].level, DiagnosticStatus::kOk);
  imu.lost = 7;
  imu.unusable = 1;
  imu.problem = "is shorter than its type";
  const DiagnosticStatus warned = node.statuses({}, {imu})[2];
  EXPECT_EQ(warned.level, DiagnosticStatus::kWarn);
  EXPECT_EQ(warned.message, "8 messages lost or of no use; /imu: a message is shorter than its type");
  EXPECT_EQ(valueOf(warned, "imu0 /imu"), "1000 received, 7 lost, 1 of no use: is shorter than its type");
  EXPECT_EQ(node.statuses({}, {imu})[2].level, DiagnosticStatus::kOk);
}

}  // namespace
}  // namespace lodeline
