#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/ahrs/attitude_filter.h"
#include "lodeline/estimate.h"
#include "lodeline/output/files/pose_writer.h"

namespace lodeline {

/// Writes `trajectory.tum` (body in world) and `states.csv` (all estimates of each frame). Each line is
/// flushed, so that an interrupted run keeps its results.
class StateWriter {
 public:
  /// `suffix` is added to the names of both files, before the dot. `sensor_columns`: names of the columns in
  /// FrameEstimate::sensor_rows. Throws InputError where the folder cannot be written to.
  explicit StateWriter(const std::filesystem::path& folder, const std::string& suffix = "",
                       const std::vector<std::string>& sensor_columns = {});

  /// `attitude`: estimate of the attitude filter at the same time, for its own columns. A frame without a
  /// pose has no line in the trajectory. In the states it has the status `attitude` and nan for unknown
  /// values or, without an attitude too, no line. Throws InputError when the disk is full.
  void write(const FrameEstimate& estimate, const std::optional<AttitudeEstimate>& attitude = std::nullopt);

 private:
  PoseWriter trajectory_;
  std::filesystem::path file_;  ///< of the states
  std::ofstream states_;
};

}  // namespace lodeline
