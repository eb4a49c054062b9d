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

/// Camera values that Kalibr's camchain does not contain; they may be given beside it.
struct EurocCameraExtras {
  double rate_hz = 0.0;
  std::string mask_file;
};
EurocCameraExtras readEurocCameraExtras(CalibrationMap* map);

}  // namespace lodeline
