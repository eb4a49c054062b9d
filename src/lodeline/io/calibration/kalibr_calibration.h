#pragma once

#include <optional>

#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/rig.h"

namespace lodeline {

/// An IMU section with Kalibr's or OpenVINS's keys.
struct KalibrImu {
  ImuCalibration calibration;
  std::optional<ImuCorrection> correction;
  /// `T_i_b`, from the frame of `T_cam_imu` to the IMU; the identity except for rigs with several IMUs.
  Rigid3 imu_from_kalibr_body;
};

/// Reads the noise, `update_rate` (0 where missing), `T_i_b`, and the keys of readImuCorrection(). The caller
/// handles unknown keys. Throws InputError naming file and key.
KalibrImu readKalibrImu(CalibrationMap* map);

/// Reads the camera `camN` of Kalibr's camchain or OpenVINS's kalibr_imucam_chain: `T_cam_imu`, its inverse
/// `T_imu_cam`, or `T_cn_cnm1` from the camera `before`; `timeshift_cam_imu`. The body frame is Kalibr's. The
/// rate is returned as 0 because Kalibr does not write it. `before` is null for the first camera.
CameraCalibration readKalibrCamera(int number, const CameraCalibration* before, CalibrationMap* map);

/// Whether a camera section uses these keys, and whether an IMU section does.
bool isKalibrCamera(const YAML::Node& section);
bool isKalibrImu(const YAML::Node& section);

}  // namespace lodeline
