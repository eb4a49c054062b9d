#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lodeline {

struct BagOptions {
  /// Files that describe the rig (see readRigFiles). Empty: NAME.rig.yaml beside NAME.bag.
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

}  // namespace lodeline
