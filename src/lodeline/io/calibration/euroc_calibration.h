#pragma once

#include <optional>
#include <string>

#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Functions that read sections with the keys of EuRoC's `sensor.yaml`, which Lodeline's rig files also use.
/// The extrinsics are those of the file, from the sensor to EuRoC's body. The caller transforms them to the
/// IMU frame where the two frames differ. Every function throws InputError naming file and key for missing or
/// wrong values. The caller handles unknown keys. A missing `rate_hz` is returned as 0.

struct EurocImu {
  ImuCalibration calibration;
  std::optional<ImuCorrection> correction;
  Rigid3 euroc_body_from_imu;
};
EurocImu readEurocImu(CalibrationMap* map);

/// `name`: for example "cam0". The mask's path is relative to the folder of the file.
CameraCalibration readEurocCamera(const std::string& name, CalibrationMap* map);
MagnetometerCalibration readEurocMagnetometer(CalibrationMap* map);
PressureCalibration readEurocPressure(CalibrationMap* map);
SonarCalibration readEurocSonar(CalibrationMap* map);

/// Reads the section dvl0 of a rig file, or dvl0/sensor.yaml:
///
///     T_BS: …
///     velocity_noise_std: 0.01   # m/s
///     range_noise_std: 0.05      # m
///     beams: {angle_deg: 22.5, azimuths_deg: [45, 135, 225, 315]}   # or a list of vectors [x, y, z]
///     scale_sigma: 0.01          # relative
///     misalignment_sigma: 0.03   # rad
///     timeshift: 0.0             # s; stamp + this = IMU clock
///
/// T_BS and velocity_noise_std are necessary. Throws InputError for wrong values.
DvlCalibration readDvl(CalibrationMap* map);

/// Reads the section current0: `channels`, by name in their order, with the field of each current, or the
/// names alone:
///
///     channels:
///       thruster_1: {field_T_per_A: [1.2e-07, -3.0e-08, 4.0e-08]}
///       lamp: {field_T_per_A: [0, 0, 2.0e-08]}
///     field_sigma_T_per_A: 5.0e-09
///     timeshift: 0.0             # s
///
/// Throws InputError for wrong values, and where only some of the channels have a field.
CurrentCalibration readCurrents(CalibrationMap* map);

/// Camera values that Kalibr's camchain does not contain; they may be given beside it.
struct EurocCameraExtras {
  double rate_hz = 0.0;
  std::string mask_file;
};
EurocCameraExtras readEurocCameraExtras(CalibrationMap* map);

}  // namespace lodeline
