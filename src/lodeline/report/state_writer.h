#pragma once

#include <filesystem>
#include <fstream>

#include "lodeline/estimator/estimator.h"

namespace lodeline {

/// Writes `trajectory.tum` (body in world) and `states.csv` (everything known of each frame), one line a
/// frame, flushed as it goes so that an interrupted run keeps what it had.
class StateWriter {
 public:
  /// Throws InputError where the folder cannot be written to.
  explicit StateWriter(const std::filesystem::path& folder);

  /// Frames without a pose are passed over. Throws InputError when the disk is full.
  void write(const FrameEstimate& estimate);

 private:
  std::filesystem::path folder_;
  std::ofstream trajectory_;
  std::ofstream states_;
};

}  // namespace lodeline
