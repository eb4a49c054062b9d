#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <memory>
#include <optional>
#include <vector>

#include "lodeline/cameras/camera.h"
#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/state/camera_states.h"
#include "lodeline/estimator/state/window.h"
#include "lodeline/factors/prior_factor.h"

namespace lodeline {

/// One term of the cost: a function, the blocks it reads (in its order) and a robust loss (null for none).
struct Factor {
  std::unique_ptr<ceres::CostFunction> function;
  std::shared_ptr<const ceres::LossFunction> loss;
  std::vector<double*> blocks;
};

/// The cost of a factor at its blocks' values; `residual` is room to work in.
double costOf(const Factor& factor, std::vector<double>& residual);

/// The terms that one landmark takes part in.
struct LandmarkFactors {
  double* landmark = nullptr;
  std::vector<Factor> factors;
};

/// Makes factors out of what the window holds. The solver, the marginalizer and the covariance all get their
/// terms here, so that a new kind of measurement is added in one place.
class FactorBuilder {
 public:
  FactorBuilder(const Rig& rig, const EstimatorOptions& options);

  /// Inertial term between `frame` and the frame before it.
  Factor inertial(const Window& window, Frame& before, Frame& frame) const;
  /// What is known beforehand of the axes of gyroscope and accelerometer, as far as they are estimated: as
  /// good as those of a calibrated one, or else anything (a Cauchy loss on all nine together) that is still
  /// sold. Stays outside of the marginalization prior, which could not hold its shape.
  std::vector<Factor> imuAxes(const Window& window) const;
  /// Term of the frame's magnetometer, if it has one; `before` is the frame before (null for the first).
  std::optional<Factor> magnetometer(const Window& window, Frame* before, Frame& frame) const;
  /// Term of the frame's depth readings, if it has any.
  std::optional<Factor> depth(const Window& window, Frame& frame) const;
  /// What is believed of a state beside all measurements (ParameterBlock::priors), if anything.
  std::optional<Factor> priorOf(ParameterBlock& state) const;
  /// What is known beforehand of where a secondary camera sits, where that is estimated: as its file says, or
  /// else anywhere. A Cauchy loss, narrower where lenses are held at their files (IntrinsicsModelSelection):
  /// who measured those well is off by a wrong length of the target or by nothing. Outside of the
  /// marginalization prior.
  std::optional<Factor> placement(ParameterBlock& secondary) const;
  /// That its velocity is zero, where the rig rests at that frame.
  std::optional<Factor> rest(Frame& frame) const;
  Factor prior(const Prior& prior) const;
  /// All observations of a track that has a landmark.
  LandmarkFactors landmark(Window& window, FeatureTrack& track) const;

  /// As the calibration files say.
  const Rigid3& bodyFromCamera(int camera) const { return body_from_camera_[camera]; }
  const Rigid3& camera0FromCamera(int camera) const { return camera0_from_camera_[camera]; }
  int cameraCount() const { return static_cast<int>(body_from_camera_.size()); }
  /// Of the Cauchy loss on the reprojection errors in a frame's images, in standard deviations.
  double robustScale(const Frame& frame) const { return frame.robust_scale_sigmas.value_or(robust_scale_); }
  /// At the true time of a frame's images, with the calibration as estimated so far.
  Rigid3 worldFromCamera(const Window& window, const Frame& frame, int camera) const;

 private:
  LandmarkFactors plainLandmark(Window& window, FeatureTrack& track) const;
  LandmarkFactors calibratedLandmark(Window& window, FeatureTrack& track, const CameraStates& states) const;

  std::vector<Rigid3> body_from_camera_;
  std::vector<Rigid3> camera0_from_camera_;
  Vec3 port_B_ = Vec3::Zero();  ///< pressure port, m
  Vec3 gravity_W_;
  ImuAxesOptions imu_axes_;
  double placement_sigma_m_;
  double robust_scale_;
};

}  // namespace lodeline
