#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/calibration/heading/inertial_calibration.h"
#include "lodeline/magnetometer/calibration/magnetometer_record.h"
#include "lodeline/magnetometer/iron/iron_calibration.h"

namespace lodeline {

struct CalibrationOptions {
  /// The Earth's field at the place of the record. It gives the scale of A and the dip for heading errors.
  std::optional<Vec3> site_field_ENU;
  std::optional<MagnetometerFit> old;
};

/// All results of a calibration.
struct MagnetometerCalibrationResult {
  MagnetometerFit fit;
  IronCalibration iron;                         ///< from the magnetometer alone
  std::optional<InertialCalibration> inertial;  ///< with gyroscope and accelerometer
  std::string without_inertial;                 ///< reason in one sentence; empty where `inertial` exists
  std::vector<Vec3> readings;  ///< usable readings without repetitions, with the indices of `iron.used`
  std::optional<double> hard_iron_step_T;  ///< size of a sudden change of the hard iron during the record
  SphereCoverage coverage;                 ///< coverage of the final calibration
  double dip_rad = 0.0;                    ///< dip for which heading errors are stated
  std::string dip_source;                  ///< "site", "measured" or "assumed"
};

/// Runs the complete calibration: screening, selection of the iron model (calibrateIron), rotation and time
/// offset (alignField), maximum likelihood (calibrateWithInertialSensors), scale and heading error. Throws
/// EstimationError, with the reasons and the remedy, where the readings cannot determine any calibration.
/// Throws InputError for an old calibration of readings in another unit.
MagnetometerCalibrationResult calibrateMagnetometer(const MagnetometerRecord& record,
                                                    const CalibrationOptions& options,
                                                    Diagnostics* diagnostics);

}  // namespace lodeline
