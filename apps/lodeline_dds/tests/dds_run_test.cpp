#include <fastcdr/Cdr.h>
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "apps/lodeline_dds/tests/test_dds_run.h"
#include "lodeline/trajectory.h"

// lodeline_dds in one process, and what publishes the sensors and hears the results in another one.

namespace lodeline::test {
namespace {

constexpr const char* kOdometry = "/lodeline/odometry";
constexpr double kDuration_s = 4.0;
/// Most time by which the messages are ahead of the poses, so that no queue overflows on a slow machine.
constexpr double kLead_s = 2.0;

/// An odometry message as Fast CDR, another implementation of CDR, takes it apart.
struct Odometry {
  int32_t seconds = 0;
  uint32_t nanoseconds = 0;
  std::string frame, child_frame;
  std::array<double, 7> pose{};
  std::array<double, 36> pose_covariance{};
  std::array<double, 6> twist{};
  std::array<double, 36> twist_covariance{};
};

Odometry decoded(std::vector<uint8_t> cdr) {
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(cdr.data()), cdr.size());
  eprosima::fastcdr::Cdr reader(buffer, eprosima::fastcdr::Cdr::DEFAULT_ENDIAN,
                                eprosima::fastcdr::Cdr::DDS_CDR);
  reader.read_encapsulation();
  Odometry message;
  reader >> message.seconds >> message.nanoseconds >> message.frame >> message.child_frame >> message.pose >>
      message.pose_covariance >> message.twist >> message.twist_covariance;
  EXPECT_EQ(reader.getSerializedDataLength(), cdr.size());
  return message;
}

std::vector<std::string> linesOf(const std::string& text, size_t count) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; lines.size() < count && std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Files of lodeline_dds equal those of `lodeline run` from the bag to the last digit, as far as both go.
void expectSameFiles(const std::filesystem::path& expected, const std::filesystem::path& actual) {
  for (const char* name : {"trajectory.tum", "states.csv"}) {
    const std::vector<std::string> lines = linesOf(readText(expected / name), SIZE_MAX);
    EXPECT_EQ(linesOf(readText(actual / name), lines.size()), lines) << name;
  }
}

Trajectory runFromBag(const DdsRun& dds, const std::string& options) {
  const Execution run = runProgram(
      fmt::format("run {} -o {} --rig {} -q --no-report --set source.duration_s={} {}", quoted(dds.bag()),
                  quoted(dds.path("run")), quoted(dds.rig()), kDuration_s, options));
  EXPECT_EQ(run.exit_code, 0) << run.output;
  Diagnostics diagnostics;
  return readTrajectory(dds.path("run/trajectory.tum"), {}, diagnostics);
}

TEST(DdsRun, PublishesTheTrajectoryThatARunFromTheBagHas) {
  DdsRun dds;
  ASSERT_EQ(dds.convertSample().exit_code, 0);
  const Trajectory expected = runFromBag(dds, "");
  ASSERT_GT(expected.poses.size(), 30U);
  TestPlayer player(dds.bag(), dds.network(), true, dds.sensorTopics());
  const std::vector<std::pair<std::string, std::string>> results = {
      {kOdometry, "nav_msgs/Odometry"},
      {"/lodeline/pose", "geometry_msgs/PoseStamped"},
      {"/lodeline/pose_with_covariance", "geometry_msgs/PoseWithCovarianceStamped"},
      {"/lodeline/path", "nav_msgs/Path"},
      {"/lodeline/landmarks", "sensor_msgs/PointCloud2"},
      {"/tf", "tf2_msgs/TFMessage"},
      {"/diagnostics", "diagnostic_msgs/DiagnosticArray"}};
  for (const auto& [topic, type] : results) player.hear(topic, type);
  dds.start({"--rig", dds.rig(), "--output", dds.path("node"), "--qos", "all=reliable:5000", "--max-images",
             "1000", "--patience-s", "2.0", "--no-report"});
  ASSERT_TRUE(player.waitForSubscribers(DdsRun::kTimeout_s)) << dds.log();

  const Time start = player.messages().front().received;
  for (const TestPlayer::Message& message : player.messages()) {
    const double time_s = (message.received - start).seconds();
    if (time_s > kDuration_s + 2.5) break;
    const auto isAhead = [&] {
      return time_s > (player.poseTime().value_or(start) - start).seconds() + kLead_s + 2.0;
    };
    for (int i = 0; isAhead(); ++i) {
      ASSERT_LT(i * 0.01, DdsRun::kTimeout_s) << dds.log();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    player.publish(message);
  }
  ASSERT_TRUE(player.waitFor(kOdometry, expected.poses.size(), DdsRun::kTimeout_s)) << dds.log();
  EXPECT_TRUE(player.waitFor("/tf", expected.poses.size(), DdsRun::kTimeout_s));
  EXPECT_TRUE(player.waitFor("/diagnostics", 1, DdsRun::kTimeout_s));
  dds.node().interrupt();
  EXPECT_EQ(dds.node().waitFor(DdsRun::kTimeout_s), 0) << dds.log();

  const std::vector<TestPlayer::Heard> heard = player.heard(kOdometry);
  for (size_t i = 0; i < expected.poses.size(); ++i) {
    const Odometry message = decoded(heard[i].cdr);
    const StampedPose& pose = expected.poses[i];
    ASSERT_EQ(message.seconds * int64_t{1'000'000'000} + message.nanoseconds, pose.time.nanoseconds());
    EXPECT_EQ(message.frame, "odom");
    EXPECT_EQ(message.child_frame, "base_link");
    const auto& p = message.pose;
    EXPECT_LT((Vec3(p[0], p[1], p[2]) - pose.world_from_body.translation).norm(), 1e-6);
    EXPECT_LT(Quat(p[6], p[3], p[4], p[5]).angularDistance(pose.world_from_body.rotation), 1e-6);
    EXPECT_GT(message.pose_covariance[35], 0.0);
    EXPECT_GT(message.twist_covariance[35], 0.0);
  }
  expectSameFiles(dds.path("run"), dds.path("node"));
  EXPECT_TRUE(std::filesystem::exists(dds.path("node/landmarks.ply")));
  for (const auto& [topic, type] : results) EXPECT_GT(player.countOf(topic), 0U) << topic;
  EXPECT_GE(player.countOf("/lodeline/pose"), expected.poses.size());
}

/// Every image is published only after the pose of the last but one: a pose that needed more than the one
/// image after its own would never come.
TEST(DdsRun, APoseComesNoLaterThanTheNextImage) {
  DdsRun dds;
  ASSERT_EQ(dds.convertSample().exit_code, 0);
  std::vector<std::string> topics = imageTopicsOf(dds.bag());
  topics.push_back("/imu0");
  TestPlayer player(dds.bag(), dds.network(), true, topics);
  player.hear(kOdometry, "nav_msgs/Odometry");
  std::string rig = readText(dds.rig());
  rig.erase(std::min(rig.find("\nmag0:"), rig.size() - 1) + 1);  // sensors beside cameras and IMU
  std::ofstream(dds.path("stereo.rig.yaml")) << rig;
  dds.start({"--rig", dds.path("stereo.rig.yaml"), "--qos", "all=reliable:5000", "--patience-s", "1000"});
  ASSERT_TRUE(player.waitForSubscribers(DdsRun::kTimeout_s)) << dds.log();

  constexpr size_t kFirst = 22;  // rates are measured by twenty images
  constexpr size_t kLast = 40;
  std::vector<Time> stamps;  // of the images of the first camera
  size_t in_step = 0;
  for (const TestPlayer::Message& message : player.messages()) {
    if (message.topic == topics[0]) {
      if (stamps.size() == kLast) break;
      if (stamps.size() > kFirst) {
        // Poses have the clock of the IMU, which is some milliseconds off.
        const Duration near = Duration::fromSeconds(0.04);
        const Time due = stamps[stamps.size() - 2];
        for (int i = 0; player.poseTime().value_or(Time()) < due - near; ++i) {
          ASSERT_LT(i * 0.002, DdsRun::kTimeout_s) << "no pose of image " << stamps.size() - 2 << dds.log();
          std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        EXPECT_LT(player.poseTime(), due + near) << "a pose without the image after its own";
        ++in_step;
      }
      stamps.push_back(message.received);
    }
    player.publish(message);
  }
  EXPECT_EQ(in_step, kLast - kFirst - 1);
  dds.node().interrupt();
  EXPECT_EQ(dds.node().waitFor(DdsRun::kTimeout_s), 0) << dds.log();
}

}  // namespace
}  // namespace lodeline::test
