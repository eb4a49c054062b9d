#pragma once

#include <optional>

#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/sensors/imu_correction.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// An IMU's section in Kalibr's or OpenVINS's keys.
struct KalibrImu {
  ImuCalibration calibration;
  std::optional<ImuCorrection> correction;
  /// `T_i_b`, from the frame of `T_cam_imu` to the IMU; the identity but for rigs of several IMUs.
  Rigid3 imu_from_kalibr_body;
};

/// Noise, `update_rate` (0 where it is missing), `T_i_b`, and what readImuCorrection() reads. Which keys are
/// unknown is left to the caller. Throws InputError naming file and key.
KalibrImu readKalibrImu(CalibrationMap* map);

/// The camera `camN` of Kalibr's camchain or of OpenVINS's kalibr_imucam_chain: `T_cam_imu`, its inverse
/// `T_imu_cam`, or `T_cn_cnm1` from the camera `before`; `timeshift_cam_imu`. The body frame is Kalibr's. The
/// rate, which Kalibr does not write, is returned as 0. `before` is null for the first one.
CameraCalibration readKalibrCamera(int number, const CameraCalibration* before, CalibrationMap* map);

/// Whether a camera's section is written in these keys, and whether an IMU's is.
bool isKalibrCamera(const YAML::Node& section);
bool isKalibrImu(const YAML::Node& section);

}  // namespace lodeline
