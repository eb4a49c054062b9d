#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/recording.h"

namespace lodeline {

/// Parts of a ROS bag to read, and where its rig is described.
struct BagOptions {
  /// Files that describe the rig (see readRigFiles). Empty: NAME.rig.yaml beside the bag.
  std::vector<std::filesystem::path> rig_files;
  /// Topics by sensor ("cam0", "imu0", …), with priority over those in the rig files. The two topics of a
  /// divided IMU are separated by a comma.
  std::map<std::string, std::string> topics;
  /// Numbers N of the camN to use, as in EurocOptions.
  std::vector<int> camera_indices;
  bool with_cameras = true;
  /// False for conversions, which use only readings: sensors without a calibration get the default one.
  bool needs_calibration = true;
  /// Stamps readings with their recording times instead of the times in their headers, for drivers that write
  /// no stamps. The recording times include the transport delay and its jitter.
  bool use_received_times = false;
};

/// Opens a ROS bag. Throws InputError where it is no bag, or no rig file describes its sensors. Throws
/// UsageError for a topic of a sensor that the rig does not have. `diagnostics` must outlive the source.
std::unique_ptr<RecordedSource> openBag(const std::filesystem::path& bag, const BagOptions& options,
                                        Diagnostics* diagnostics);

}  // namespace lodeline
