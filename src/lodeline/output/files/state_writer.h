#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "lodeline/ahrs/attitude_filter.h"
#include "lodeline/estimator/estimator.h"

namespace lodeline {

/// Writes `trajectory.tum` (body in world) and `states.csv` (everything known of each frame), one line a
/// frame, flushed as it goes so that an interrupted run keeps what it had.
class StateWriter {
 public:
  /// `suffix` goes to the names of both files, before the dot. Throws InputError where the folder cannot be
  /// written to.
  explicit StateWriter(const std::filesystem::path& folder, const std::string& suffix = "");

  /// `attitude`: what the attitude filter knows at the same time, in its own columns. A frame without a pose
  /// is no line of the trajectory; in the states it has the status `attitude` and nan for what is not known,
  /// or, with no attitude either, no line. Throws InputError when the disk is full.
  void write(const FrameEstimate& estimate, const std::optional<AttitudeEstimate>& attitude = std::nullopt);

 private:
  void writeTrajectory(const FrameEstimate& estimate);

  std::filesystem::path file_;  ///< of the trajectory
  std::ofstream trajectory_;
  std::ofstream states_;
};

}  // namespace lodeline
