#pragma once

#include <filesystem>
#include <fstream>

#include "lodeline/io/synchronizer/frame_packet.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Writes `magnetometer.csv`: the newest reading of each frame, as read (magnetometer axes) and corrected by
/// the calibration (body axes), T. It shows whether a calibration fits the recording.
class MagnetometerWriter {
 public:
  /// Throws InputError where the folder cannot be written to.
  MagnetometerWriter(const std::filesystem::path& folder, const MagnetometerCalibration& calibration);

  void write(const FramePacket& packet);

 private:
  MagnetometerCalibration calibration_;
  std::ofstream stream_;
};

}  // namespace lodeline
