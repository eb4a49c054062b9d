#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/rig_calibration/record/board_record.h"

namespace lodeline::test {

/// A simulated calibration without images: corners are projected and get noise.
struct BoardTrial {
  uint64_t seed = 1;
  double duration_s = 20.0;
  double frame_rate_hz = 5.0;
  double pixel_sigma_px = 0.1;
  double delay_s = -0.006;            ///< stamp + delay = IMU clock
  std::optional<double> frozen_at_s;  ///< the rig stays where it is at this second
  std::optional<Port> port;           ///< before every camera; the lenses are then those in air
  std::string camera_model;           ///< empty: the lenses of the simulated rig
};

/// The true rig of a trial.
Rig trueRig(const BoardTrial& trial);

/// The record of a trial. The stated rig is the true one.
BoardRecord boardRecord(const BoardTrial& trial);

}  // namespace lodeline::test
