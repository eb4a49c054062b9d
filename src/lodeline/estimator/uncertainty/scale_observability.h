#pragma once

#include <optional>

#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/state/window.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// What each source says of the length of a metre, as information 1 / sigma^2 of the logarithm of the scale.
struct ScaleInformation {
  double stereo = 0.0;
  double accelerometer = 0.0;
  double depth = 0.0;

  double sum() const { return stereo + accelerometer + depth; }
};

/// Keeps an account of what carries the scale, beside the estimator and without effect on it. Every source is
/// taken by itself, over the half-minute for which images hand a scale on:
/// - stereo: the baseline b, known as the calibration is, sigma^2 = (sigma_b / b)^2 +
///   (sigma_rotation d / b)^2 at the mean distance d of what both cameras see (a turn of one camera moves all
///   points). A rotation that images confirm is known to a tenth of its sigma (IntrinsicsModelSelection); of
///   a baseline that was found to be off, its file says as little as the robust loss has left of it;
/// - accelerometer: changes of the acceleration against the noise of its integral; what is constant counts as
///   bias and tilt; never better than the 0.1 % that files leave open, nor than uncalibrated_sigma of an IMU
///   that was perhaps never calibrated (estimator/inertial_states.h);
/// - depth: changes of the height against the readings' sigma, and the water's density.
class ScaleObservability {
 public:
  ScaleObservability(const Rig& rig, const EstimatorOptions& options);

  /// The window with its newest frame solved. `density_sigma`: what is known of a depth gauge's ratio of
  /// densities (DepthFactor's k) without images.
  ScaleInformation add(const Window& window, double density_sigma);

 private:
  /// Weighted scatter of a quantity about its mean, with a memory.
  class Scatter {
   public:
    void fade(double keep);
    void add(const Vec3& value, double weight);
    /// Weighted sum of squared distances from the mean.
    double sum() const;

   private:
    double weight_ = 0.0;
    Vec3 mean_ = Vec3::Zero();
    double squares_ = 0.0;
  };

  double stereoInformation(const Window& window) const;

  std::optional<double> baseline_m_;
  CameraCalibrationOptions calibration_;
  ImuAxesOptions imu_axes_;
  Scatter accelerations_, heights_;
  std::optional<Time> last_;
};

}  // namespace lodeline
