#pragma once

#include <optional>

#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/sensors/imu_correction.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// Reads the four noise densities that EuRoC and Kalibr name alike. Throws InputError where one is missing or
/// not positive.
ImuNoise readImuNoise(CalibrationMap* map);

/// Reads scale, misalignment and bias of an IMU, which may stand in any section imu0:
///
/// - Kalibr's `gyroscopes: {M, C_gyro_i, A}`, `accelerometers: {M}` of its `model: scale-misalignment`, and
///   `time_offset`; Lodeline's own rig files may add a `bias` to either;
/// - OpenVINS's `Tw`, `R_IMUtoGYRO`, `Tg`, `Ta`, `R_IMUtoACC`.
///
/// Nothing where they say that the IMU is ideal. Throws InputError for a model that is not known or whose
/// matrices are missing, for matrices that cannot be those of a sensor, and for levers between the
/// accelerometer's axes (`scale-misalignment-size-effect`) that are not zero, which are not supported.
std::optional<ImuCorrection> readImuCorrection(CalibrationMap* map);

}  // namespace lodeline
