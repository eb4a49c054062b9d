#pragma once

#include <optional>
#include <string>

#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/sensors/imu_correction.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// Readers of sections in the keys of EuRoC's `sensor.yaml`, which are those of Lodeline's rig files too.
/// Extrinsics come as the file says them, from the sensor to EuRoC's body; the caller moves them to the IMU
/// frame where the two differ. Every function throws InputError naming file and key for what is missing or
/// wrong; which keys are unknown is left to the caller. A `rate_hz` that the file leaves out is returned as
/// 0.

struct EurocImu {
  ImuCalibration calibration;
  std::optional<ImuCorrection> correction;
  Rigid3 euroc_body_from_imu;
};
EurocImu readEurocImu(CalibrationMap* map);

/// `name`: for example "cam0". The mask's path is resolved against the file's folder.
CameraCalibration readEurocCamera(const std::string& name, CalibrationMap* map);
MagnetometerCalibration readEurocMagnetometer(CalibrationMap* map);
PressureCalibration readEurocPressure(CalibrationMap* map);
SonarCalibration readEurocSonar(CalibrationMap* map);

/// What Kalibr's camchain does not hold, beside which it may stand.
struct EurocCameraExtras {
  double rate_hz = 0.0;
  std::string mask_file;
};
EurocCameraExtras readEurocCameraExtras(CalibrationMap* map);

}  // namespace lodeline
