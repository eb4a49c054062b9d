#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <thread>

#include "apps/lodeline_dds/tests/test_dds_run.h"
#include "lodeline/io/rosbag/definitions/message_conversion.h"
#include "lodeline/io/rosbag/definitions/message_text.h"

// What lodeline_dds does where something is wrong.

namespace lodeline::test {
namespace {

using ::testing::HasSubstr;

/// All diagnostics so far as text.
std::string diagnosticsOf(const TestPlayer& player) {
  const auto form =
      definitions::knownForm("diagnostic_msgs/DiagnosticArray", definitions::Serialization::Cdr);
  std::string text;
  for (const TestPlayer::Heard& heard : player.heard("/diagnostics")) {
    text += definitions::messageText(heard.cdr, form.type, form.serialization, SIZE_MAX) + "\n";
  }
  return text;
}

std::string lastOf(const std::string& lines) {
  return lines.substr(lines.size() > 1 ? lines.rfind('\n', lines.size() - 2) + 1 : 0);
}

/// Waits until the diagnostics say something.
bool waitForDiagnostics(const TestPlayer& player, const std::string& text) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(DdsRun::kTimeout_s);
  while (diagnosticsOf(player).find(text) == std::string::npos) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return true;
}

class DdsFaults : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(dds_.convertSample().exit_code, 0); }

  int exitCodeWith(const std::vector<std::string>& options) {
    dds_.start(options);
    return dds_.node().waitFor(DdsRun::kTimeout_s);
  }

  DdsRun dds_;
};

TEST_F(DdsFaults, SayWhatIsWrongWithTheOptions) {
  EXPECT_EQ(exitCodeWith({}), 2);
  EXPECT_THAT(dds_.log(), HasSubstr("rig: missing"));
  EXPECT_EQ(exitCodeWith({"--rig", dds_.rig(), "--topics", "cam7=/left"}), 2);
  EXPECT_THAT(dds_.log(), HasSubstr("cam7"));
  EXPECT_EQ(exitCodeWith({"--rig", dds_.rig(), "--topics", "cam0=/no good"}), 2);
  EXPECT_THAT(dds_.log(), HasSubstr("no name of a topic"));
  EXPECT_EQ(exitCodeWith({"--rig", dds_.rig(), "--domain", "500"}), 2);
  EXPECT_EQ(exitCodeWith({"--rig", dds_.path("missing.yaml")}), 1);
}

TEST_F(DdsFaults, EndWellBeforeAnySensorIsHeard) {
  TestPlayer player(dds_.bag(), dds_.network(), true, {"/imu0"});
  player.hear("/diagnostics", "diagnostic_msgs/DiagnosticArray");
  dds_.start({"--rig", dds_.rig()});
  EXPECT_TRUE(waitForDiagnostics(player, "waiting for messages of IMU, cam0, cam1")) << dds_.log();
  dds_.node().interrupt();
  EXPECT_EQ(dds_.node().waitFor(DdsRun::kTimeout_s), 0);
  EXPECT_THAT(dds_.log(), HasSubstr("ended before all sensors were heard"));
}

TEST_F(DdsFaults, TellWrongTypesAndDamagedMessages) {
  const std::string image_topic = imageTopicsOf(dds_.bag())[0];
  TestPlayer player(dds_.bag(), dds_.network(), true, {image_topic, "/imu0"});
  player.hear("/diagnostics", "diagnostic_msgs/DiagnosticArray");
  // The topic of images for the IMU, and the other way round.
  dds_.start({"--rig", dds_.rig(), "--topics", "imu0=" + image_topic, "cam0=/imu0"});
  EXPECT_TRUE(waitForDiagnostics(player, "is of type sensor_msgs/Imu, which cam0 does not have"))
      << lastOf(diagnosticsOf(player)) << dds_.log();
  dds_.node().interrupt();
  EXPECT_EQ(dds_.node().waitFor(DdsRun::kTimeout_s), 0) << dds_.log();
  dds_.start({"--rig", dds_.rig(), "--qos", "all=reliable"});
  ASSERT_TRUE(player.waitForSubscribers(DdsRun::kTimeout_s)) << dds_.log();
  player.publishBytes("/imu0", {});
  player.publishBytes("/imu0", {0, 1, 0, 0, 1});
  player.publishBytes(image_topic, {0, 9, 0, 0, 255, 255, 255, 255, 255, 255, 255, 255});
  player.publishBytes(image_topic, std::vector<uint8_t>(3, 255));
  EXPECT_TRUE(waitForDiagnostics(player, "0 lost, 2 of no use"))
      << lastOf(diagnosticsOf(player)) << dds_.log();
  dds_.node().interrupt();
  EXPECT_EQ(dds_.node().waitFor(DdsRun::kTimeout_s), 0) << dds_.log();
}

TEST_F(DdsFaults, DropTheOldestImagesUnderOverloadAndTellIt) {
  std::vector<std::string> topics = imageTopicsOf(dds_.bag());
  topics.push_back("/imu0");
  TestPlayer player(dds_.bag(), dds_.network(), false, topics);
  player.hear("/diagnostics", "diagnostic_msgs/DiagnosticArray");
  dds_.start({"--rig", dds_.rig(), "--output", dds_.path("node"), "--max-images", "20", "--no-report"});
  ASSERT_TRUE(player.waitForSubscribers(DdsRun::kTimeout_s)) << dds_.log();
  // Twenty seconds of a dive in a fraction of their time, with the quality of service of sensors.
  for (const TestPlayer::Message& message : player.messages()) player.publish(message);
  const auto isTold = [&] {
    const std::string text = diagnosticsOf(player);
    const size_t lost = text.rfind("image_dropped");
    return lost != std::string::npos || text.find("messages lost or of no use") != std::string::npos;
  };
  for (int i = 0; !isTold(); ++i) {
    ASSERT_LT(i * 0.1, DdsRun::kTimeout_s) << lastOf(diagnosticsOf(player)) << dds_.log();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  dds_.node().interrupt();
  EXPECT_EQ(dds_.node().waitFor(DdsRun::kTimeout_s), 0) << dds_.log();
}

/// Addresses to which the sockets of a process are bound, in the hexadecimal form of /proc.
std::set<std::string> boundAddresses(pid_t pid) {
  std::set<std::string> inodes, addresses;
  for (const auto& entry : std::filesystem::directory_iterator(fmt::format("/proc/{}/fd", pid))) {
    std::error_code ignored;
    const std::string target = std::filesystem::read_symlink(entry, ignored).string();
    if (target.starts_with("socket:[")) inodes.insert(target.substr(8, target.size() - 9));
  }
  for (const char* table : {"udp", "udp6", "tcp", "tcp6"}) {
    std::ifstream file(fmt::format("/proc/{}/net/{}", pid, table));
    std::string line;
    std::getline(file, line);  // names of the columns
    while (std::getline(file, line)) {
      std::istringstream words(line);
      const std::vector<std::string> columns{std::istream_iterator<std::string>(words), {}};
      if (columns.size() > 9 && inodes.contains(columns[9]))
        addresses.insert(columns[1].substr(0, columns[1].find(':')));
    }
  }
  return addresses;
}

TEST_F(DdsFaults, StayOnThisMachineUnlessToldOtherwise) {
  constexpr const char* kLoopback = "0100007F";   // 127.0.0.1
  constexpr const char* kDiscovery = "0100FFEF";  // 239.255.0.1, joined on the loopback interface
  TestPlayer player(dds_.bag(), dds_.network(), true, {"/imu0"});
  player.hear("/diagnostics", "diagnostic_msgs/DiagnosticArray");
  dds_.start({"--rig", dds_.rig()});
  ASSERT_TRUE(player.waitFor("/diagnostics", 1, DdsRun::kTimeout_s)) << dds_.log();
  const std::set<std::string> addresses = boundAddresses(dds_.node().id());
  EXPECT_TRUE(addresses.contains(kLoopback));
  for (const std::string& address : addresses) {
    EXPECT_TRUE(address == kLoopback || address == kDiscovery) << address;
  }
}

}  // namespace
}  // namespace lodeline::test
