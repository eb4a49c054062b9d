#pragma once

#include <filesystem>
#include <string>

#include "lodeline/io/synchronizer/recording_file.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Writes a `sensor.yaml` with EuRoC's keys for every sensor of the rig into mav0/cam0, mav0/imu0 and so on.
/// The numbers keep all their bits when read back.
void writeCalibration(const Rig& rig, const std::filesystem::path& mav0);

/// A vector, or a matrix by rows, as a list of YAML.
std::string numbers(const Vec3& v);
std::string numbers(const Mat3& m);

}  // namespace lodeline
