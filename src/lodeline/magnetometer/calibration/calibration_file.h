#pragma once

#include <filesystem>
#include <string>

#include "lodeline/magnetometer/iron/magnetometer_fit.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// A calibration as YAML, with a comment on every key; numbers read back to the same bits.
/// docs/magnetometer_calibration.md lists the keys.
std::string calibrationYaml(const MagnetometerFit& fit);

/// Writes calibrationYaml() to a file. Throws InputError where that fails.
void writeCalibrationFile(const MagnetometerFit& fit, const std::filesystem::path& file);

/// Reads what writeCalibrationFile() wrote. `iron_correction` and `hard_iron_T` (or `hard_iron_raw`) are
/// enough; everything else may be missing. Throws InputError naming file, line and key for what is missing,
/// misspelt or impossible, e.g. a matrix that is not symmetric and positive definite.
MagnetometerFit readCalibrationFile(const std::filesystem::path& file);

/// Gives the rig's magnetometer the calibration. What the file does not know (rotation, noise, time offset)
/// stays as the rig has it. `file` is for messages. Throws InputError where the rig has no magnetometer or
/// the calibration is for raw counts, which no recording holds.
void applyCalibration(const MagnetometerFit& fit, const std::filesystem::path& file, Rig* rig);

}  // namespace lodeline
