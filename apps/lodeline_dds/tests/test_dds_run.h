#pragma once

#include <unistd.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/lodeline/tests/test_program.h"
#include "apps/lodeline_dds/tests/test_player.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/util/files/test_data.h"
#include "lodeline/util/files/test_process.h"

namespace lodeline::test {

/// The sample dive as a bag of ROS 2, and lodeline_dds as another process in a domain that no other test has.
class DdsRun {
 public:
  /// Enough for a machine that does much else; nothing waits so long where all is well.
  static constexpr double kTimeout_s = 60.0;

  DdsRun() {
    static int runs = 0;
    network_.domain = 1 + (static_cast<int>(getpid()) * 7 + runs++) % 100;
  }

  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
  std::filesystem::path bag() const { return path("dive.mcap"); }
  std::filesystem::path rig() const { return path("dive.rig.yaml"); }
  const dds::NetworkOptions& network() const { return network_; }
  std::string log() const { return readText(path("node.log")); }

  /// Result of `lodeline convert`.
  Execution convertSample() const {
    return runProgram("convert " + quoted(sampleDive()) + " " + quoted(bag()));
  }
  static std::filesystem::path sampleDive() { return testSourceDir() / "samples/cave_dive"; }

  /// Topics of all sensors of the sample dive.
  std::vector<std::string> sensorTopics() const {
    std::vector<std::string> topics = imageTopicsOf(bag());
    topics.insert(topics.end(), {"/imu0", "/mag0", "/pressure0", "/sonar0"});
    return topics;
  }

  /// Starts lodeline_dds.
  void start(std::vector<std::string> options) {
    options.insert(options.begin(), {LODELINE_DDS, "--domain", std::to_string(network_.domain)});
    node_.emplace(options, path("node.log").string());
  }
  ChildProcess& node() { return *node_; }

 private:
  TemporaryFolder folder_;
  dds::NetworkOptions network_;
  std::optional<ChildProcess> node_;
};

}  // namespace lodeline::test
