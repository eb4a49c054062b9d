#pragma once

#include <filesystem>
#include <string>

#include "lodeline/base/diagnostics.h"
#include "lodeline/data/yaml_file.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// Readers of the `sensor.yaml` files of an EuRoC ASL recording. Extrinsics come as the files say them, from
/// the sensor to EuRoC's body; the caller moves them to the IMU frame where the two differ. Every function
/// throws InputError naming file and key for what is missing or wrong, and reports unknown keys as notices.
/// A `rate_hz` that the file leaves out is returned as 0.

struct EurocImu {
  ImuCalibration calibration;
  Rigid3 euroc_body_from_imu;
};

EurocImu readEurocImu(const std::filesystem::path& file, Diagnostics* diagnostics);

/// What Kalibr's camchain does not hold.
struct EurocCameraExtras {
  double rate_hz = 0.0;
  std::string mask_file;
};

EurocCameraExtras readEurocCameraExtras(const std::filesystem::path& file);

/// `name`: for example "cam0". The mask's path is resolved against the file's folder.
CameraCalibration readEurocCamera(const std::filesystem::path& file, const std::string& name,
                                  Diagnostics* diagnostics);

MagnetometerCalibration readEurocMagnetometer(const std::filesystem::path& file, Diagnostics* diagnostics);
PressureCalibration readEurocPressure(const std::filesystem::path& file, Diagnostics* diagnostics);
SonarCalibration readEurocSonar(const std::filesystem::path& file, Diagnostics* diagnostics);

/// The same from one map of keys; which keys of it are unknown is left to the caller.
EurocImu readEurocImu(CalibrationMap* map);
CameraCalibration readEurocCamera(const std::string& name, CalibrationMap* map);
MagnetometerCalibration readEurocMagnetometer(CalibrationMap* map);
PressureCalibration readEurocPressure(CalibrationMap* map);
SonarCalibration readEurocSonar(CalibrationMap* map);
EurocCameraExtras readEurocCameraExtras(CalibrationMap* map);

}  // namespace lodeline
