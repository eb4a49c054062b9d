#include "lodeline/pipeline/open_recording.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/logs/log_source.h"
#include "lodeline/io/logs/open_sensor_log.h"
#include "lodeline/io/video/video_folder.h"
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

bool isVideo(const std::filesystem::path& data) {
  const RecognizedFile recognized = recognizeFile(data);
  if (recognized.kind == FileKind::Folder) return findVideoFolder(data).has_value();
  if (recognized.kind == FileKind::Video) return recognized.advice.empty();
  if (recognized.kind != FileKind::Missing) return false;
  constexpr std::array kExtensions = {".mp4", ".MP4", ".mov", ".MOV", ".mkv", ".avi"};
  return std::find(kExtensions.begin(), kExtensions.end(), data.extension().string()) != kExtensions.end();
}

void refuseRigOfFolder(const std::filesystem::path& data, const BagArguments& bag_arguments) {
  if (bag_arguments.rig_files.empty() || !std::filesystem::is_directory(data)) return;
  if (isBag(data) || isVideo(data)) return;
  throw UsageError(
      fmt::format("--rig is for ROS bags and films here; {} is {}", data.string(), recognizeFile(data).what));
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
        fmt::format("--rig is for ROS bags, films and folders; {} is {}", data.string(), recognized.what));
  }
}

OpenedReadings openReadings(const std::filesystem::path& data, const BagArguments& bag_arguments,
                            Diagnostics* diagnostics) {
  if (isVideo(data)) {
    EurocOptions options;
    options.with_cameras = options.needs_calibration = false;
    std::unique_ptr<VideoSource> film = openVideo(data, options, bag_arguments, diagnostics);
    RigSections sections = film->rigFile().sections;
    return {std::move(film), std::move(sections)};
  }
  BagOptions options = bagOptions(bag_arguments);
  options.with_cameras = false;
  options.needs_calibration = false;
  auto bag = std::make_unique<BagSource>(data, options, diagnostics);
  RigSections sections = bag->rigFile().sections;
  return {std::move(bag), std::move(sections)};
}

std::unique_ptr<VideoSource> openVideo(const std::filesystem::path& film, const EurocOptions& options,
                                       const BagArguments& bag_arguments, Diagnostics* diagnostics) {
  VideoOptions video_options;
  video_options.rig_files.assign(bag_arguments.rig_files.begin(), bag_arguments.rig_files.end());
  video_options.camera_indices = options.camera_indices;
  video_options.with_cameras = options.with_cameras;
  video_options.needs_calibration = options.needs_calibration;
  return std::make_unique<VideoSource>(film, video_options, diagnostics);
}

std::unique_ptr<RecordedSource> openRecording(const std::filesystem::path& data, const EurocOptions& options,
                                              const BagArguments& bag_arguments, Diagnostics* diagnostics) {
  const bool is_bag = isBag(data), is_video = !is_bag && isVideo(data);
  if (!is_bag) refuseBagOptions(data, bag_arguments);
  if (!is_bag && !is_video) {
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
  if (!options.needs_calibration && bag_arguments.rig_files.empty() &&
      !std::filesystem::exists(rigFileBeside(data))) {
    diagnostics->report(
        Severity::Warning, is_bag ? "bag_uncalibrated" : "video_uncalibrated",
        fmt::format("{}: no rig file (--rig) and none beside the {} ({}); sensors are taken as they are, in "
                    "body axes",
                    data.string(), is_bag ? "bag" : "film", rigFileBeside(data).string()));
  }
  if (is_video) return openVideo(data, options, bag_arguments, diagnostics);
  BagOptions bag_options = bagOptions(bag_arguments);
  bag_options.camera_indices = options.camera_indices;
  bag_options.with_cameras = options.with_cameras;
  bag_options.needs_calibration = options.needs_calibration;
  return std::make_unique<BagSource>(data, bag_options, diagnostics);
}

MagnetometerRecord readMagnetometerRecord(const std::filesystem::path& data,
                                          const BagArguments& bag_arguments, const RecordOptions& options,
                                          Diagnostics* diagnostics) {
  refuseBagOptions(data, bag_arguments);
  refuseRigOfFolder(data, bag_arguments);
  if (!isBag(data) && !isVideo(data)) return readMagnetometerRecord(data, options, diagnostics);
  const OpenedReadings opened = openReadings(data, bag_arguments, diagnostics);
  return readMagnetometerRecord(*opened.source, data.string(), opened.sections.contains("mag0"), options,
                                diagnostics);
}

}  // namespace lodeline
