#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/euroc_rig.h"
#include "lodeline/io/rosbag/bag_source.h"
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

/// Whether a path is a ROS 1 bag, by its content, or by its name if it does not exist.
bool isBag(const std::filesystem::path& data);

/// Whether a path is a file with a table of readings; false for bags and folders. Throws InputError, with its
/// kind, for any other file.
bool isTableOfReadings(const std::filesystem::path& data);

/// Throws UsageError for --topic where `data` is not a bag, and for --rig where it is neither a bag nor a
/// folder.
void refuseBagOptions(const std::filesystem::path& data, const BagArguments& bag_arguments);

/// Throws UsageError for rig files with a folder, for commands that use the folder's own sensor files.
void refuseRigOfFolder(const std::filesystem::path& data, const BagArguments& bag_arguments);

/// Opens a bag for its readings alone, without images. Sensors without a rig file have the default
/// calibration. Throws as BagSource does; `diagnostics` must outlive the source.
std::unique_ptr<BagSource> openBagReadings(const std::filesystem::path& bag,
                                           const BagArguments& bag_arguments, Diagnostics* diagnostics);

/// Opens a folder in the EuRoC ASL layout, or a ROS 1 bag. Throws as EurocSource and BagSource do, and
/// UsageError for --topic with a folder. `diagnostics` must outlive the source.
std::unique_ptr<RecordedSource> openRecording(const std::filesystem::path& data, const EurocOptions& options,
                                              const BagArguments& bag_arguments, Diagnostics* diagnostics);

/// Reads the input of a magnetometer calibration from a folder, a bag or a table. Throws as the function of
/// magnetometer_record.h does, and UsageError for options that do not suit the data.
MagnetometerRecord readMagnetometerRecord(const std::filesystem::path& data,
                                          const BagArguments& bag_arguments, const RecordOptions& options,
                                          Diagnostics* diagnostics);

}  // namespace lodeline
