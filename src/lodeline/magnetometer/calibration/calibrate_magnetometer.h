#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/magnetometer/calibration/heading/inertial_calibration.h"
#include "lodeline/magnetometer/calibration/magnetometer_record.h"
#include "lodeline/magnetometer/iron/iron_calibration.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

struct CalibrationOptions {
  /// The Earth's field where the sensor was turned; gives A its scale and the dip for heading errors.
  std::optional<Vec3> site_field_ENU;
  std::optional<MagnetometerFit> old;
};

/// Everything a calibration found out.
struct MagnetometerCalibrationResult {
  MagnetometerFit fit;
  IronCalibration iron;                         ///< from the magnetometer alone
  std::optional<InertialCalibration> inertial;  ///< with gyroscope and accelerometer
  std::string without_inertial;                 ///< why not, one sentence; empty where it is there
  std::vector<Vec3> readings;                   ///< usable, free of repetitions, as `iron.used` counts them
  std::optional<double> hard_iron_step_T;       ///< by which the hard iron changed at once during the record
  SphereCoverage coverage;                      ///< of the final calibration
  double dip_rad = 0.0;                         ///< that heading errors are given for
  std::string dip_source;                       ///< "site", "measured" or "assumed"
};

/// The whole way from readings to a verdict: screening, ellipsoid and ladder (calibrateIron), rotation and
/// time offset (alignField), maximum likelihood (calibrateWithInertialSensors), scale and heading error.
/// Throws EstimationError, with the reasons and what to do, where the readings cannot calibrate anything, and
/// InputError for an old calibration of readings in another unit.
MagnetometerCalibrationResult calibrateMagnetometer(const MagnetometerRecord& record,
                                                    const CalibrationOptions& options,
                                                    Diagnostics* diagnostics);

}  // namespace lodeline
