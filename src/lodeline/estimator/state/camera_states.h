#pragma once

#include <optional>
#include <vector>

#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/state/window.h"
#include "lodeline/factors/prior_factor.h"

namespace lodeline {

/// The parameter blocks of the camera calibration, see factors/calibrated_reprojection_factor.h; null and
/// empty where it is not estimated.
struct CameraStates {
  ParameterBlock* camera0 = nullptr;
  ParameterBlock* time_offset = nullptr;
  std::vector<ParameterBlock*> secondary;   ///< of camera 1, 2, ...
  std::vector<ParameterBlock*> intrinsics;  ///< of every camera; empty where the lenses are not estimated

  explicit operator bool() const { return camera0 != nullptr; }
  double timeOffset_s() const { return time_offset ? time_offset->value[0] : 0.0; }
};

/// Adds placement and delay of as many cameras as the rig has, and to the prior what `options` say of them.
/// `rotations`: from which those of secondary cameras start, see FrameTracks::camera_rotations.
void addCameraStates(Window& window, Prior& prior, int cameras, const CameraCalibrationOptions& options,
                     const std::vector<Vec3>& rotations = {});
/// The same for their lenses, where these are to be estimated.
void addIntrinsicsStates(Window& window, Prior& prior, int cameras, const CameraCalibrationOptions& options);

CameraStates cameraStates(const Window& window);

/// Width of the Cauchy loss on where a secondary camera sits, in sigmas of what its file says
/// (FactorBuilder::placement): half as wide where its file is held, which is then wrong in lengths or not at
/// all.
double placementLossWidth(const ParameterBlock& secondary);

/// Prior sigmas of each coordinate of a secondary camera's rotation (the first of its placement) and of a
/// lens.
Eigen::VectorXd stereoRotationSigmas(const CameraCalibrationOptions& options);
Eigen::VectorXd intrinsicsSigmas(const CameraCalibrationOptions& options);

/// The ray of an observation (its camera's frame) by the lens that the states say, by the file's where they
/// are empty.
Vec3 rayOf(const Observation& observation, const CameraStates& states);

/// What the states say at present.
struct CameraCorrections {
  std::vector<Eigen::Matrix<double, 6, 1>> extrinsics;  ///< [phi, xi] of each camera, rad and m
  double time_offset_s = 0.0;                           ///< to add to the images' stamps
  /// Of each camera as in factors/intrinsics_factor.h; empty where the lenses are not estimated.
  std::vector<Eigen::Matrix<double, 6, 1>> intrinsics;
  bool are_files_held = false;  ///< of lenses and secondary cameras' rotations, see IntrinsicsModelSelection
};
std::optional<CameraCorrections> cameraCorrections(const Window& window);

}  // namespace lodeline
