#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lodeline/cameras/camera.h"

namespace lodeline {

/// Plane in which a small error of a lens is a polynomial. Its radius is the tangent of the angle to the
/// optical axis, or the angle itself.
enum class RadialPlane { Tangent, Angle };

/// COLMAP's name of a model and its number of parameters after fx, fy, cx, cy, in Lodeline's order.
/// Parameters that a calibration lacks are zero.
struct ColmapForm {
  std::string_view name;
  size_t parameters = 0;
};

/// Lens of the simulator and of the tests: focal length on the axis over the image width, and the parameters.
struct TypicalLens {
  double focal_length_share = 0.7;
  std::vector<double> parameters;
};

/// All that the program knows about one camera model. The parameters of a camera are fx, fy, cx, cy (px) and
/// the `parameters` of its model. Readers, writers, estimator and simulator find every model in
/// cameraModels().
struct CameraModel {
  std::string_view name;  ///< CameraCalibration::model

  /// Values of `camera_model` and `distortion_model` in files that have these two keys (EuRoC, Kalibr,
  /// OpenVINS, rig files). Writers use the first ones.
  std::vector<std::string_view> projections = {"pinhole"};
  std::vector<std::string_view> distortions = {"none", ""};
  /// Names in files that have one name for the whole model (OKVIS, VINS, Basalt, ORB-SLAM3, ROS).
  std::vector<std::string_view> aliases = {};

  std::vector<std::string_view> parameters = {};
  std::vector<size_t> counts = {0};  ///< permitted numbers of parameters, ascending
  /// Number of parameters that precede fx in Kalibr's `intrinsics`. The others are distortion coefficients.
  size_t before_focal_lengths = 0;
  /// States what is wrong with finite parameters of a permitted number. Empty where nothing is.
  std::string (*fault)(const std::vector<double>& parameters) = nullptr;
  std::shared_ptr<const Camera> (*make)(const CameraCalibration& calibration) = nullptr;

  RadialPlane plane = RadialPlane::Angle;
  /// Name of the model that contains this one and begins with coefficients of the radius in `plane`, second
  /// and fourth power. Empty where there is none.
  std::string_view radial_model = {};
  /// Place of the first of two tangential coefficients among the parameters, if the model has any.
  std::optional<size_t> tangential_at = {};
  std::vector<ColmapForm> colmap = {};  ///< by ascending number of parameters
  TypicalLens typical;

  bool takes(size_t count) const;
  /// The permitted numbers of parameters after the first `without` ones in words, for example "4, 5 or 8".
  std::string countWords(size_t without = 0) const;
};

/// All registered models in the order of registration.
const std::vector<CameraModel>& cameraModels();

/// The model with a name or alias; null for an unknown name.
const CameraModel* findCameraModel(std::string_view name);

/// The model of a pair of values of `camera_model` and `distortion_model`; null where there is none.
const CameraModel* findCameraModel(std::string_view projection, std::string_view distortion);

/// The model that a calibration names. Throws InputError for an unknown name.
const CameraModel& cameraModel(const CameraCalibration& calibration);

/// Names of all models, separated by commas, for messages.
std::string cameraModelNames();

/// Pixels per radian on the axis of a calibrated camera, along u. Zero for a camera without calibration
/// (width or focal length 0). Throws InputError for invalid parameters.
double focalLengthOnAxis_px(const CameraCalibration& calibration);

}  // namespace lodeline
