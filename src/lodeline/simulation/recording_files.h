#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "lodeline/sensors/rig.h"

namespace lodeline {

/// A text file that is being written, its folder created. Throws InputError, naming the path, where that
/// fails.
class RecordingFile {
 public:
  explicit RecordingFile(const std::filesystem::path& path);
  void write(const std::string& text);
  /// Throws where anything could not be written, e.g. on a full disk.
  void close();

 private:
  std::filesystem::path path_;
  std::ofstream stream_;
};

/// Writes a `sensor.yaml` in EuRoC's keys for every sensor of the rig into mav0/cam0, mav0/imu0 and so on.
/// Numbers read back to the same bits.
void writeCalibration(const Rig& rig, const std::filesystem::path& mav0);

}  // namespace lodeline
