#pragma once

#include <string>
#include <vector>

#include "lodeline/cameras/camera_model.h"

namespace lodeline {

/// A camera by the keys that EuRoC, Kalibr, OpenVINS and rig files use. `intrinsics` are fx, fy, cx, cy (px).
/// Parameters of the projection precede them, for example [xi, alpha, fx, fy, cx, cy] for `ds`.
struct CameraFileKeys {
  std::string camera_model;
  std::string distortion_model;
  std::vector<double> intrinsics;
  std::vector<double> distortion_coefficients;
};

/// The keys of a calibration. Throws InputError for an unknown model.
CameraFileKeys cameraFileKeys(const CameraCalibration& calibration);

/// Sets model, focal lengths, principal point and parameters from keys. `model` is the model of the two
/// names, and `intrinsics` has before_focal_lengths + 4 numbers.
void setFromFileKeys(const CameraModel& model, const CameraFileKeys& keys, CameraCalibration* calibration);

/// Names of the numbers in `intrinsics`, for example "xi, alpha, fx, fy, cx, cy".
std::string intrinsicsNames(const CameraModel& model);

/// All permitted values of `camera_model` with their values of `distortion_model`, for messages.
std::string cameraFileModels();

}  // namespace lodeline
