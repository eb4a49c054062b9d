#pragma once

#include <optional>
#include <vector>

#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/state/window.h"
#include "lodeline/factors/prior_factor.h"

namespace lodeline {

/// The global states of the camera calibration, see factors/calibrated_reprojection_factor.h; null and empty
/// where it is not estimated.
struct CameraStates {
  GlobalState* camera0 = nullptr;
  GlobalState* time_offset = nullptr;
  std::vector<GlobalState*> further;     ///< of camera 1, 2, ...
  std::vector<GlobalState*> intrinsics;  ///< of every camera; empty where the lenses are not estimated

  explicit operator bool() const { return camera0 != nullptr; }
  double timeOffset_s() const { return time_offset ? time_offset->value[0] : 0.0; }
};

/// Adds placement and delay of as many cameras as the rig has, and to the prior what `options` say of them.
/// `rotations`: from which those of further cameras start, see FrameTracks::camera_rotations.
void addCameraStates(Window& window, Prior& prior, int cameras, const CameraCalibrationOptions& options,
                     const std::vector<Vec3>& rotations = {});
/// The same for their lenses, where these are to be estimated.
void addLensStates(Window& window, Prior& prior, int cameras, const CameraCalibrationOptions& options);

CameraStates cameraStates(const Window& window);

/// Width of the Cauchy loss on where a further camera sits, in sigmas of what its file says
/// (FactorMaker::placement): half as wide where its file is held, which is then wrong in lengths or not at
/// all.
double placementLossWidth(const GlobalState& further);

/// Prior sigmas of each coordinate of a further camera's rotation (the first of its placement) and of a lens.
Eigen::VectorXd stereoRotationSigmas(const CameraCalibrationOptions& options);
Eigen::VectorXd lensSigmas(const CameraCalibrationOptions& options);

/// The ray of a sighting (its camera's frame) by the lens that the states say, by the file's where they are
/// empty.
Vec3 rayOf(const Sighting& sighting, const CameraStates& states);

/// What the states say at present.
struct CameraCorrections {
  std::vector<Eigen::Matrix<double, 6, 1>> extrinsics;  ///< [phi, xi] of each camera, rad and m
  double time_offset_s = 0.0;                           ///< to add to the images' stamps
  /// Of each camera as in factors/intrinsics_factor.h; empty where the lenses are not estimated.
  std::vector<Eigen::Matrix<double, 6, 1>> intrinsics;
  bool are_files_held = false;  ///< of lenses and further cameras' rotations, see LensTrust
};
std::optional<CameraCorrections> cameraCorrections(const Window& window);

}  // namespace lodeline
