#pragma once

#include <optional>

#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Reads the four noise densities, which have the same keys in EuRoC and Kalibr. Throws InputError where one
/// is missing or not positive.
ImuNoise readImuNoise(CalibrationMap* map);

/// Reads scale, misalignment and bias of an IMU. The keys may be in any section imu0:
///
/// - Kalibr's `gyroscopes: {M, C_gyro_i, A}`, `accelerometers: {M}` of its `model: scale-misalignment`, and
///   `time_offset`; Lodeline's own rig files may add a `bias` to either;
/// - OpenVINS's `Tw`, `R_IMUtoGYRO`, `Tg`, `Ta`, `R_IMUtoACC`.
///
/// Returns nothing where the keys describe an ideal IMU. Throws InputError for an unknown model, missing
/// matrices or matrices that no sensor can have. Also throws for non-zero lever arms between the
/// accelerometer axes (`scale-misalignment-size-effect`), which are not supported.
std::optional<ImuCorrection> readImuCorrection(CalibrationMap* map);

}  // namespace lodeline
