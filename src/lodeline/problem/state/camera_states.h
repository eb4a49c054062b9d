#pragma once

#include <optional>
#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/factors/prior_factor.h"
#include "lodeline/factors/rolling_shutter.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Parameter blocks of the camera calibration, see factors/calibrated_reprojection_factor.h; null and empty
/// where it is not estimated.
struct CameraStates {
  ParameterBlock* camera0 = nullptr;
  ParameterBlock* time_offset = nullptr;
  ParameterBlock* shutter = nullptr;       ///< null where all shutters are global (factors/rolling_shutter.h)
  std::vector<ParameterBlock*> secondary;  ///< of camera 1, 2, ...
  std::vector<ParameterBlock*> intrinsics;  ///< of every camera; empty where they are not estimated
  /// Of every camera, null without a port (factors/ports/port_factor.h); empty where no port is estimated.
  std::vector<ParameterBlock*> ports;

  explicit operator bool() const { return camera0 != nullptr; }
  ParameterBlock* portOf(int camera) const {
    return ports.empty() ? nullptr : ports[static_cast<size_t>(camera)];
  }
  double timeOffset_s() const { return time_offset ? time_offset->value[0] : 0.0; }
};

/// Adds the extrinsics and time offset of the rig's cameras, and their priors by `options`. `rotations`:
/// initial rotations of the secondary cameras, see FrameTracks::camera_rotations.
void addCameraStates(Window& window, Prior& prior, int cameras, const CameraCalibrationOptions& options,
                     const std::vector<Vec3>& rotations = {});
/// Adds the line delays of the rig's rolling shutters, where it has any and the calibration is estimated.
void addShutterState(Window& window, Prior& prior, const Rig& rig, const CameraCalibrationOptions& options);
/// Adds the intrinsics of the cameras, where these are to be estimated.
void addIntrinsicsStates(Window& window, Prior& prior, int cameras, const CameraCalibrationOptions& options);
/// Adds the ports of the rig's cameras, where the intrinsics are estimated. For the batch solution alone: the
/// terms of the window (visual/reprojection_system.h) have constant ports.
void addPortStates(Window& window, Prior& prior, const Rig& rig, const CameraCalibrationOptions& options);

CameraStates cameraStates(const Window& window);

/// Width of the Cauchy loss on a secondary camera's position, in sigmas of its file
/// (FactorBuilder::placement). It is half as wide where the camera's file is held: such a file is either
/// wrong by the length of the target or not at all.
double placementLossWidth(const ParameterBlock& secondary);

/// Prior sigmas of each coordinate of a secondary camera's rotation (the first three of its extrinsics) and
/// of the intrinsics.
Eigen::VectorXd stereoRotationSigmas(const CameraCalibrationOptions& options);
Eigen::VectorXd intrinsicsSigmas(const CameraCalibrationOptions& options);

/// Ray of an observation (in its camera's frame) by the estimated intrinsics, or by those of the file where
/// the states are empty.
Vec3 rayOf(const Observation& observation, const CameraStates& states);

/// The measurement of an observation as of the time of its image (factors/rolling_shutter.h).
DirectionMeasurement atTimeOfImage(const Observation& observation, const CameraMotion& motion,
                                   const CameraStates& states);

std::optional<CameraCorrections> cameraCorrections(const Window& window);

}  // namespace lodeline
