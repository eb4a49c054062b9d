#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lodeline/cameras/ports/refractive_camera.h"
#include "lodeline/factors/prior_factor.h"
#include "lodeline/factors/rolling_shutter.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/problem/state/camera_states.h"
#include "lodeline/problem/state/factor.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Makes the factors of images, inertial readings and priors from the contents of the window, for solver,
/// marginalizer and covariance. Every other sensor makes its own factors (Measurement::factors).
class FactorBuilder {
 public:
  FactorBuilder(const Rig& rig, const EstimatorOptions& options);

  /// Inertial term between `frame` and the frame before it.
  Factor inertial(const Window& window, Frame& before, Frame& frame) const;
  /// Priors of the axes of gyroscope and accelerometer, where they are estimated. A Cauchy loss on all nine
  /// together describes a calibrated sensor with heavy tails, and a second prior for the worst sensors on
  /// the market. They are not part of the marginalization prior, which could not represent their shape.
  std::vector<Factor> imuAxes(const Window& window) const;
  /// Prior of a state beside all measurements (ParameterBlock::priors), if there is one.
  std::optional<Factor> priorOf(ParameterBlock& state) const;
  /// Prior of a secondary camera's position, where it is estimated, with residual xi / sigma: the position of
  /// its file under a Cauchy loss. The loss is narrower where the intrinsics are held at their files
  /// (IntrinsicsModelSelection): a file with accurate intrinsics has a baseline that is either wrong by the
  /// length of the target or correct. It is not part of the marginalization prior.
  std::optional<Factor> placement(ParameterBlock& secondary) const;
  /// Zero-velocity update, residual v_W / sigma, where the rig rests at that frame.
  std::optional<Factor> rest(Frame& frame) const;
  Factor prior(const Prior& prior) const;
  /// Terms of all observations of a track that has a landmark.
  LandmarkFactors landmark(Window& window, FeatureTrack& track) const;

  /// The measurement of an observation by the present line delay and port of its camera.
  DirectionMeasurement presentMeasurement(const Window& window, const Observation& observation,
                                          const CameraStates& states) const;

  /// Poses by the calibration files.
  const Rigid3& bodyFromCamera(int camera) const { return body_from_camera_[camera]; }
  /// Motion of a camera while its rows are read (factors/rolling_shutter.h).
  CameraMotion motionOf(const Frame& frame, int camera) const {
    return {frame.image_motion, body_from_camera_[camera], centre_rows_[camera]};
  }
  const Rigid3& camera0FromCamera(int camera) const { return camera0_from_camera_[camera]; }
  int cameraCount() const { return static_cast<int>(body_from_camera_.size()); }
  /// Width of the Cauchy loss on the reprojection residuals of a frame's images, in standard deviations.
  double robustScale(const Frame& frame) const { return frame.robust_scale_sigmas.value_or(robust_scale_); }
  /// Pose of a camera at the true time of a frame's images, with the present estimate of the calibration.
  Rigid3 worldFromCamera(const Window& window, const Frame& frame, int camera) const;

 private:
  /// Term of one observation by its ray, without intrinsics and port.
  Factor rayFactor(Window& window, const Landmark& landmark, double* parameters,
                   const Observation& observation, const DirectionMeasurement& measurement,
                   const CameraStates& states) const;
  LandmarkFactors plainLandmark(Window& window, FeatureTrack& track) const;
  /// Term of one observation with another measurement than the recorded one.
  Factor calibratedFactor(Window& window, const Landmark& landmark, double* parameters,
                          const Observation& observation, const DirectionMeasurement& measurement,
                          const CameraStates& states) const;
  /// The same with the line delay of its camera as a variable.
  Factor shutterFactor(Window& window, const Landmark& landmark, double* parameters,
                       const Observation& observation, const CameraStates& states) const;
  LandmarkFactors calibratedLandmark(Window& window, FeatureTrack& track, const CameraStates& states) const;

  std::vector<Rigid3> body_from_camera_;
  std::vector<Rigid3> camera0_from_camera_;
  std::vector<double> centre_rows_;                                   ///< of rolling shutters, 0 otherwise
  std::vector<std::shared_ptr<const RefractiveCamera>> behind_port_;  ///< null without a port
  Vec3 gravity_W_;
  ImuAxesOptions imu_axes_;
  double placement_sigma_m_;
  double robust_scale_;
};

}  // namespace lodeline
