#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <sstream>

#include "apps/lodeline/tests/test_program.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/io/rosbag/ros1/ros1_bag.h"
#include "lodeline/io/rosbag/topic_choice.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/files/test_data.h"
#include "lodeline/util/files/test_process.h"
#include "lodeline_ros/message_types.h"
#include "lodeline_ros/raw_message.h"

// Runs the node with a roscore and the messages of a bag.

namespace lodeline::test {
namespace {

using ::testing::HasSubstr;

constexpr double kDuration_s = 4.0;
/// Maximum time between the bag and the poses, so that no queue overflows on a slow machine.
constexpr double kLead_s = 2.0;
constexpr double kTimeout_s = 40.0;

bool waitUntil(const std::function<bool()>& condition, double timeout_s = kTimeout_s) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(timeout_s);
  while (!condition()) {
    if (ros::WallTime::now() > end) return false;
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.002));
  }
  return true;
}

double firstImageTime_s(const BagFile& bag) {
  return imageTopics(bag).front()->entries.front().received.seconds();
}

/// All messages received on a topic.
template <typename Message>
class Heard {
 public:
  Heard(ros::NodeHandle* node, const std::string& topic) {
    const boost::function<void(const boost::shared_ptr<const Message>&)> keep =
        [this](const boost::shared_ptr<const Message>& message) { messages.push_back(*message); };
    subscriber_ = node->subscribe<Message>(topic, 0, keep);
  }
  bool isConnected() const { return subscriber_.getNumPublishers() > 0; }

  std::vector<Message> messages;

 private:
  ros::Subscriber subscriber_;
};

struct Shared {
  std::filesystem::path path(const std::string& name) const { return folder.path() / name; }

  void start(const std::filesystem::path& recording) {
    const Execution converted =
        runProgram(fmt::format("convert {} {}", quoted(recording), quoted(path("dive.bag"))));
    ASSERT_EQ(converted.exit_code, 0) << converted.output;
    const int port = freePort();
    setenv("ROS_MASTER_URI", fmt::format("http://127.0.0.1:{}", port).c_str(), 1);
    setenv("ROS_IP", "127.0.0.1", 1);
    setenv("ROS_HOME", path("ros_home").c_str(), 1);
    master.emplace(std::vector<std::string>{"roscore", "-p", std::to_string(port)},
                   path("roscore.log").string());
    std::map<std::string, std::string> no_remapping;
    ros::init(no_remapping, "lodeline_node_test", ros::init_options::NoSigintHandler);
    waitUntil([] { return ros::master::check(); });
  }

  TemporaryFolder folder;
  std::optional<ChildProcess> master;
};

class NodeTest : public ::testing::Test {
 protected:
  /// One master and one bag for all tests, because a process can have only one master.
  static void SetUpTestSuite() {
    const std::optional<std::filesystem::path> recording = testData(kMh01Recording);
    if (std::system("command -v roscore > /dev/null") != 0) {
      missing_ = "no roscore (Debian's python3-roslaunch is not installed)";
    } else if (!recording) {
      missing_ = missingTestData(kMh01Recording);
    } else {
      shared_ = std::make_unique<Shared>();
      shared_->start(*recording);
    }
  }
  static void TearDownTestSuite() {
    if (ros::isStarted()) ros::shutdown();
    shared_.reset();
  }
  void SetUp() override {
    if (!shared_) GTEST_SKIP() << missing_;
    ASSERT_TRUE(ros::master::check()) << readText(shared_->path("roscore.log"));
  }

  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
  std::filesystem::path bag() const { return shared_->path("dive.bag"); }
  std::string rigParameter() const { return "_rig:=" + shared_->path("dive.rig.yaml").string(); }

  void startNode(std::vector<std::string> parameters) {
    parameters.insert(parameters.begin(), {LODELINE_ROS_NODE, "__name:=lodeline"});
    node_.emplace(parameters, path("node.log").string());
  }

  /// Publishes the bag's messages in the order of reception, up to the end of the test.
  void play(const std::function<double()>& pose_time_s) {
    ros::NodeHandle node;
    Diagnostics diagnostics;
    Ros1Bag bag(this->bag(), &diagnostics);
    std::vector<std::pair<BagEntry, const ros::Publisher*>> order;
    std::deque<ros::Publisher> publishers;
    for (const BagTopic& topic : bag.topics()) {
      const BagConnection& connection = topic.connection;
      ros::AdvertiseOptions options(connection.topic, 0, connection.md5sum, connection.type, "unused");
      publishers.push_back(node.advertise(options));
      for (const BagEntry& entry : topic.entries) order.emplace_back(entry, &publishers.back());
    }
    std::stable_sort(order.begin(), order.end(),
                     [](const auto& a, const auto& b) { return a.first.received < b.first.received; });
    ASSERT_TRUE(waitUntil([&] {
      return std::count_if(publishers.begin(), publishers.end(), [](const ros::Publisher& publisher) {
               return publisher.getNumSubscribers() > 0;
             }) == 3;  // two cameras and the IMU
    })) << readText(path("node.log"));
    const double start_s = firstImageTime_s(bag);
    for (const auto& [entry, publisher] : order) {
      const double time_s = entry.received.seconds();
      if (time_s > start_s + kDuration_s + 1.0) break;
      ASSERT_TRUE(waitUntil([&] { return time_s < std::max(pose_time_s(), start_s) + kLead_s; }));
      publisher->publish(RawMessage{bag.stored(entry).value()});
    }
  }

  TemporaryFolder folder_;
  static inline std::unique_ptr<Shared> shared_;
  static inline std::string missing_;
  std::optional<ChildProcess> node_;
};

std::vector<std::string> linesOf(const std::string& text, size_t count) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; lines.size() < count && std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST_F(NodeTest, PublishesTheTrajectoryThatARunFromTheBagHas) {
  const Execution run = runProgram(fmt::format("run {} -o {} -q --no-report --set source.duration_s={}",
                                               quoted(bag()), quoted(path("run")), kDuration_s));
  ASSERT_EQ(run.exit_code, 0) << run.output;
  Diagnostics diagnostics;
  const Trajectory expected = readTrajectory(path("run/trajectory.tum"), {}, diagnostics);
  ASSERT_GT(expected.poses.size(), 60U);

  ros::NodeHandle handle;
  const Heard<message::Odometry> odometry(&handle, "/lodeline/odometry");
  const Heard<message::Path> way(&handle, "/lodeline/path");
  const Heard<message::PointCloud2> landmarks(&handle, "/lodeline/landmarks");
  const Heard<message::TFMessage> transforms(&handle, "/tf");
  const Heard<message::DiagnosticArray> said(&handle, "/diagnostics");
  startNode({rigParameter(), "_output:=" + path("node").string(), "_max_images:=1000", "_patience_s:=2.0"});
  ASSERT_TRUE(waitUntil([&] {
    return odometry.isConnected() && transforms.isConnected() && way.isConnected() && landmarks.isConnected();
  })) << readText(path("node.log"));
  play([&] { return odometry.messages.empty() ? 0.0 : odometry.messages.back().header.stamp.toSec(); });
  EXPECT_TRUE(waitUntil([&] {
    return odometry.messages.size() >= expected.poses.size() &&
           transforms.messages.size() >= expected.poses.size() && !said.messages.empty();
  })) << readText(path("node.log"));
  node_->interrupt();
  EXPECT_EQ(node_->waitFor(20.0), 0) << readText(path("node.log"));

  ASSERT_GE(odometry.messages.size(), expected.poses.size());
  for (size_t i = 0; i < expected.poses.size(); ++i) {
    const message::Odometry& message = odometry.messages[i];
    const StampedPose& pose = expected.poses[i];
    const auto& position = message.pose.pose.position;
    ASSERT_EQ(static_cast<int64_t>(message.header.stamp.toNSec()), pose.time.nanoseconds());
    EXPECT_LT((Vec3(position.x, position.y, position.z) - pose.world_from_body.translation).norm(), 1e-6);
    const auto& q = message.pose.pose.orientation;
    EXPECT_LT(Quat(q.w, q.x, q.y, q.z).angularDistance(pose.world_from_body.rotation), 1e-6);
    EXPECT_GT(message.pose.covariance[35], 0.0);
    EXPECT_EQ(transforms.messages[i].transforms.at(0).transform.translation.x, position.x);
  }
  // The files of the node equal those of the program to the last digit, as far as both go.
  for (const char* name : {"trajectory.tum", "states.csv"}) {
    const std::vector<std::string> lines = linesOf(readText(path(std::string("run/") + name)), SIZE_MAX);
    EXPECT_EQ(linesOf(readText(path(std::string("node/") + name)), lines.size()), lines) << name;
  }
  EXPECT_GT(readJson(path("node/run.json")).at("frames").get<int>(), 60);
  EXPECT_TRUE(std::filesystem::exists(path("node/landmarks.ply")));
  ASSERT_FALSE(way.messages.empty());
  EXPECT_GT(way.messages.back().poses.size(), 3U);
  ASSERT_FALSE(landmarks.messages.empty());
  EXPECT_GT(landmarks.messages.back().width, 20U);
  EXPECT_EQ(said.messages.back().status.at(0).name, "lodeline: estimator");
}

TEST_F(NodeTest, SaysWhatIsWrongWithItsParameters) {
  startNode({rigParameter(), "_outptu:=" + path("node").string()});
  EXPECT_EQ(node_->waitFor(20.0), 2);
  EXPECT_THAT(readText(path("node.log")), HasSubstr("did you mean ~output?"));
}

}  // namespace
}  // namespace lodeline::test
