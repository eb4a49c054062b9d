#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/euroc_rig.h"
#include "lodeline/io/rosbag/bag_source.h"
#include "lodeline/io/video/video_source.h"
#include "lodeline/magnetometer/calibration/magnetometer_record.h"
#include "lodeline/recording.h"

namespace lodeline {

/// Options of the command line on a recording's sensors.
struct BagArguments {
  std::vector<std::string> rig_files;
  std::vector<std::string> topics;  ///< SENSOR=TOPIC
  bool use_received_times = false;
};

/// Topics by sensor. Throws UsageError where one is not of the form SENSOR=TOPIC.
std::map<std::string, std::string> topicsOf(const BagArguments& arguments);

/// Whether a path is a ROS bag, by its content, or by its name if it does not exist.
bool isBag(const std::filesystem::path& data);

/// Whether a path is a film, by its content, or by its name if it does not exist; or a folder with a film and
/// tables of readings of a phone.
bool isVideo(const std::filesystem::path& data);

/// Throws UsageError for --topic where `data` is not a bag, and for --rig where it is neither a bag nor a
/// film nor a folder.
void refuseBagOptions(const std::filesystem::path& data, const BagArguments& bag_arguments);

/// Throws UsageError for rig files with a folder, for commands that use the folder's own sensor files.
void refuseRigOfFolder(const std::filesystem::path& data, const BagArguments& bag_arguments);

/// A recording opened for its readings, and the sections of its rig file.
struct OpenedReadings {
  std::unique_ptr<RecordedSource> source;
  RigSections sections;
};

/// Opens a bag or a film for its readings alone, without images. Sensors without a rig file have the default
/// calibration. Throws as BagSource and VideoSource do; `diagnostics` must outlive the source.
OpenedReadings openReadings(const std::filesystem::path& data, const BagArguments& bag_arguments,
                            Diagnostics* diagnostics);

/// Opens a film; `options` as for openRecording(). Throws as VideoSource does.
std::unique_ptr<VideoSource> openVideo(const std::filesystem::path& film, const EurocOptions& options,
                                       const BagArguments& bag_arguments, Diagnostics* diagnostics);

/// Opens a folder in the EuRoC ASL layout, a ROS bag, a film or, where `options` need no cameras, a sensor
/// log. Throws as EurocSource, BagSource, VideoSource and LogSource do, and UsageError for --topic without a
/// bag. `diagnostics` must outlive the source.
std::unique_ptr<RecordedSource> openRecording(const std::filesystem::path& data, const EurocOptions& options,
                                              const BagArguments& bag_arguments, Diagnostics* diagnostics);

/// Reads the input of a magnetometer calibration from a folder, a bag or a table. Throws as the function of
/// magnetometer_record.h does, and UsageError for options that do not suit the data.
MagnetometerRecord readMagnetometerRecord(const std::filesystem::path& data,
                                          const BagArguments& bag_arguments, const RecordOptions& options,
                                          Diagnostics* diagnostics);

}  // namespace lodeline
