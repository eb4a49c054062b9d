#include "lodeline/cli/open_recording.h"

#include <fmt/core.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "lodeline/base/error.h"
#include "lodeline/data/euroc_source.h"

namespace lodeline {
namespace {

BagOptions bagOptions(const BagArguments& arguments) {
  BagOptions options;
  options.rig_files.assign(arguments.rig_files.begin(), arguments.rig_files.end());
  options.topics = topicsOf(arguments);
  options.use_received_times = arguments.use_received_times;
  return options;
}

}  // namespace

void addBagOptions(BagArguments* arguments, CLI::App* command) {
  command
      ->add_option(
          "--rig", arguments->rig_files,
          "for a bag: calibration of the rig (rig.yaml, or Kalibr's camchain-imucam.yaml and imu.yaml); "
          "without it NAME.rig.yaml beside NAME.bag")
      ->type_name("FILE");
  command
      ->add_option(
          "--topic", arguments->topics,
          "for a bag: the topic of a sensor (cam0, imu0, mag0, pressure0, sonar0); found by type where it "
          "is not named")
      ->type_name("SENSOR=TOPIC");
  command->add_flag(
      "--received-times", arguments->use_received_times,
      "for a bag whose header stamps are not filled: stamp messages with the times at which they "
      "were recorded, which are late and uneven");
}

std::map<std::string, std::string> topicsOf(const BagArguments& arguments) {
  std::map<std::string, std::string> topics;
  for (const std::string& text : arguments.topics) {
    const size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      throw UsageError(fmt::format("--topic {}: expected SENSOR=TOPIC, as in cam0=/left/image_raw", text));
    }
    topics[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return topics;
}

bool isBag(const std::filesystem::path& data) {
  const std::string name = data.filename().string();
  return data.extension() == ".bag" || name.ends_with(".bag.active");
}

void refuseBagOptions(const std::filesystem::path& data, const BagArguments& bag_arguments) {
  if (isBag(data) ||
      (bag_arguments.rig_files.empty() && bag_arguments.topics.empty() && !bag_arguments.use_received_times))
    return;
  throw UsageError(
      fmt::format("--rig, --topic and --received-times are for ROS bags; {} is none", data.string()));
}

std::unique_ptr<BagSource> openBagReadings(const std::filesystem::path& bag,
                                           const BagArguments& bag_arguments, Diagnostics* diagnostics) {
  BagOptions options = bagOptions(bag_arguments);
  options.with_cameras = false;
  options.needs_calibration = false;
  return std::make_unique<BagSource>(bag, options, diagnostics);
}

std::unique_ptr<RecordedSource> openRecording(const std::filesystem::path& data, const EurocOptions& options,
                                              const BagArguments& bag_arguments, Diagnostics* diagnostics) {
  if (!isBag(data)) {
    refuseBagOptions(data, bag_arguments);
    return std::make_unique<EurocSource>(data, options, diagnostics);
  }
  BagOptions bag_options = bagOptions(bag_arguments);
  bag_options.camera_indices = options.camera_indices;
  bag_options.with_cameras = options.with_cameras;
  bag_options.needs_calibration = options.needs_calibration;
  if (!options.needs_calibration && bag_options.rig_files.empty() &&
      !std::filesystem::exists(rigFileBeside(data))) {
    diagnostics->report(Severity::Warning, "bag_uncalibrated",
                        fmt::format("{}: no rig file (--rig) and none beside the bag ({}); sensors are taken "
                                    "as they are, in body axes",
                                    data.string(), rigFileBeside(data).string()));
  }
  return std::make_unique<BagSource>(data, bag_options, diagnostics);
}

}  // namespace lodeline
