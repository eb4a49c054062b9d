#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "lodeline/magnetometer/calibration/magnetometer_record.h"
#include "lodeline/magnetometer/currents/current_check.h"
#include "lodeline/magnetometer/currents/current_fit.h"
#include "lodeline/magnetometer/iron/magnetometer_fit.h"

namespace lodeline {

/// Reads a still test from an open recording; pulls its readings to the end. `name`, `is_mounting_known`,
/// `options`: as for readMagnetometerRecord(). `iron`: calibration of the magnetometer, for headings and its
/// lag, where there is one. Throws InputError for a recording without currents or with raw counts, and where
/// current readings have another number of channels than the recording names.
StillTest readStillTest(MeasurementSource& source, const std::string& name, bool is_mounting_known,
                        const RecordOptions& options, const std::optional<MagnetometerFit>& iron,
                        Diagnostics* diagnostics);

/// All results of a calibration of currents.
struct CurrentCalibrationResult {
  CurrentFit fit;
  CurrentCalibration calibration;
  std::optional<CurrentCheck> check;  ///< of an earlier calibration
};

/// Fits the test, and compares with an earlier calibration where there is one. Throws as fitCurrents() and
/// checkCurrents() do.
CurrentCalibrationResult calibrateCurrents(const StillTest& test,
                                           const std::optional<CurrentCalibration>& earlier,
                                           Diagnostics* diagnostics);

/// Writes a rig file with the section current0 alone, and the verdict as a comment. Throws InputError on
/// failure.
void writeCurrentFile(const CurrentCalibrationResult& result, const std::filesystem::path& file);

/// Reads the section current0 of a rig file. Throws InputError where it is missing or wrong.
CurrentCalibration readCurrentFile(const std::filesystem::path& file);

}  // namespace lodeline
