#pragma once

#include <optional>

#include "lodeline/estimate.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/problem/state/window.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Computes which sensors determine the scale, without any effect on the estimator. Each source is evaluated
/// by itself, over the half-minute for which images carry a scale onwards:
/// - stereo: the baseline b with the uncertainty of its calibration, sigma^2 = (sigma_b / b)^2 +
///   (sigma_rotation d / b)^2. d is the mean distance of the points that both cameras observe, because a
///   rotation of one camera moves all points. A rotation that images confirm is known to a tenth of its
///   sigma (IntrinsicsModelSelection). The file's information about a baseline that was found to be wrong is
///   what the robust loss leaves of it;
/// - accelerometer: changes of the velocity compared with the noise of the integrated acceleration and with
///   that of the velocity which images give. A constant part counts as bias and tilt. The sigma is never
///   below the 0.1 % that files leave open, nor below uncalibrated_sigma of an IMU that may never have been
///   calibrated (problem/state/inertial_states.h);
/// - depth: changes of the height compared with the readings' sigma, and the density of the water;
/// - DVL: its velocities compared with their noise, and the calibration of its scale.
class ScaleObservability {
 public:
  ScaleObservability(const Rig& rig, const EstimatorOptions& options);

  /// Updates the information from a window whose newest frame is solved. `density_sigma`: sigma of a depth
  /// gauge's density ratio (k of DepthFactor) without images. `velocity_covariance_W`: of the newest frame.
  ScaleInformation add(const Window& window, double density_sigma, const Mat3& velocity_covariance_W);

 private:
  /// Weighted scatter of a quantity about its mean, with fading weights.
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
  double dvl_scale_sigma_ = 0.0;
  Scatter accelerations_, heights_;
  double speeds_ = 0.0;  ///< Measurement::speedInformation, fading
  std::optional<Time> last_;
};

}  // namespace lodeline
