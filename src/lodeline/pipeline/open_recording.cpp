#include "lodeline/pipeline/open_recording.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/logs/log_source.h"
#include "lodeline/util/files/file_kind.h"

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
  const RecognizedFile recognized = recognizeFile(data);
  constexpr std::array kBags = {FileKind::Ros1Bag, FileKind::Ros2Bag, FileKind::Mcap, FileKind::Ros2Folder};
  if (std::find(kBags.begin(), kBags.end(), recognized.kind) != kBags.end()) return true;
  if (recognized.kind != FileKind::Missing) return false;
  const std::string name = data.filename().string();
  const std::string extension = data.extension().string();
  return extension == ".bag" || extension == ".mcap" || extension == ".db3" || name.ends_with(".bag.active");
}

void refuseRigOfFolder(const std::filesystem::path& data, const BagArguments& bag_arguments) {
  if (bag_arguments.rig_files.empty() || !std::filesystem::is_directory(data) || isBag(data)) return;
  throw UsageError(
      fmt::format("--rig is for ROS bags here; {} is {}", data.string(), recognizeFile(data).what));
}

void refuseBagOptions(const std::filesystem::path& data, const BagArguments& bag_arguments) {
  if (isBag(data)) return;
  const bool is_for_bags = !bag_arguments.topics.empty() || bag_arguments.use_received_times;
  if (is_for_bags && std::filesystem::exists(data)) {
    throw UsageError(fmt::format("--topic and --received-times are for ROS bags; {} is {}", data.string(),
                                 recognizeFile(data).what));
  }
  if (!bag_arguments.rig_files.empty() && std::filesystem::is_regular_file(data)) {
    const RecognizedFile recognized = recognizeFile(data);
    constexpr std::array kLogs = {FileKind::Table, FileKind::Text, FileKind::SensorLog, FileKind::Archive,
                                  FileKind::Compressed};
    const bool is_log = std::find(kLogs.begin(), kLogs.end(), recognized.kind) != kLogs.end();
    if (!is_log) return;  // rejected by its kind
    throw UsageError(
        fmt::format("--rig is for ROS bags and folders; {} is {}", data.string(), recognized.what));
  }
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
    const bool wants_images = options.with_cameras && options.needs_cameras;
    if (!wants_images && isSensorLog(data)) {
      if (!bag_arguments.rig_files.empty()) {
        throw UsageError(
            fmt::format("--rig is for ROS bags and folders with mav0; {} is a sensor log, whose "
                        "readings are taken in the axes of the log",
                        data.string()));
      }
      return std::make_unique<LogSource>(data, diagnostics);
    }
    EurocOptions folder_options = options;
    folder_options.rig_files.assign(bag_arguments.rig_files.begin(), bag_arguments.rig_files.end());
    return std::make_unique<EurocSource>(data, folder_options, diagnostics);
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
