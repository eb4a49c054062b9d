#pragma once

#include <filesystem>
#include <string>

#include "lodeline/magnetometer/iron/magnetometer_fit.h"
#include "lodeline/rig.h"

namespace lodeline {

/// A calibration as YAML, with a comment on every key. The numbers keep all their bits when read back.
/// docs/reference/file-formats.md lists the keys.
std::string calibrationYaml(const MagnetometerFit& fit);

/// Writes calibrationYaml() to a file. Throws InputError on failure.
void writeCalibrationFile(const MagnetometerFit& fit, const std::filesystem::path& file);

/// Reads a file of writeCalibrationFile(). Only `iron_correction` and `hard_iron_T` (or `hard_iron_raw`) are
/// required. Throws InputError naming file, line and key for missing, misspelt or impossible values, e.g. a
/// matrix that is not symmetric and positive definite.
MagnetometerFit readCalibrationFile(const std::filesystem::path& file);

/// Applies the calibration to the rig's magnetometer. Values missing in the file (rotation, noise, time
/// offset) stay unchanged. `file` is for messages. Throws InputError where the rig has no magnetometer or the
/// calibration is for raw counts, which no recording contains.
void applyCalibration(const MagnetometerFit& fit, const std::filesystem::path& file, Rig* rig);

}  // namespace lodeline
