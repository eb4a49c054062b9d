#pragma once

#include "lodeline/ahrs/low_pass.h"
#include "lodeline/types.h"

namespace lodeline {

struct GyroscopeBiasOptions {
  double initial_sigma_rad_per_s = 0.035;  ///< initial bias after power-on, 2 deg/s
  double largest_rad_per_s = 0.17;         ///< 10 deg/s; a larger mean is not a bias
  /// Without measurements, the sigma of the bias grows to `forgotten_sigma_rad_per_s` in this time.
  double forgetting_s = 100.0;
  double forgotten_sigma_rad_per_s = 1.75e-3;
  /// White noise density of the bias measurements: one sigma of the bias from one second of them.
  double rest_density_rad_per_s_sqrtHz = 1.6e-3;
  double motion_density_rad_per_s_sqrtHz = 0.0175;
  /// After a start in motion, the inclination corrections are dominated by the error of the initial
  /// inclination. Their sigma is therefore multiplied by sqrt(1 + (settling_s / t)^2), with t the time since
  /// the start.
  double settling_s = 20.0;
  /// A mean rate at rest is a slow rotation where it differs from the bias by more than this plus three
  /// sigmas.
  double slow_turn_rad_per_s = 5e-3;
};

/// Kalman filter of the gyroscope bias in body axes. At rest it measures the bias directly. In motion it
/// measures the two horizontal components from the rate of the accelerometer's inclination corrections
/// (Laidig & Seel, "VQF", Information Fusion 2023, section 3.6).
class GyroscopeBiasFilter {
 public:
  /// `inclination_time_constant_s`: time constant of the filter that produced the inclination correction.
  GyroscopeBiasFilter(const GyroscopeBiasOptions& options, double inclination_time_constant_s);

  /// Update at rest with the mean of the gyroscope's readings. Returns false where that is a slow rotation
  /// and not a bias.
  bool updateAtRest(const Vec3& mean_rate_B, double step_s);

  /// Update in motion: `correction_W` is the rotation vector (rad) by which the accelerometer corrected the
  /// attitude in this step.
  void updateInMotion(const Vec3& correction_W, double step_s);

  /// Applies the delay of the inclination corrections to the attitude. Call it every step, before either
  /// update.
  void follow(const Mat3& world_from_body, double step_s);

  /// Discards the delayed attitudes after a loss of attitude; keeps the bias.
  void restart();

  const Vec3& bias_B() const { return bias_B_; }
  const Mat3& covariance() const { return covariance_; }

 private:
  void predict(double step_s);
  void correct(const Vec3& innovation, const Mat3& model, const Vec3& variance);

  GyroscopeBiasOptions options_;
  Vec3 bias_B_ = Vec3::Zero();
  Mat3 covariance_;
  LowPass<Mat3> delayed_attitude_;  ///< world from body
  LowPass<Vec3> delayed_bias_W_;
  double since_start_s_ = 0.0;
};

}  // namespace lodeline
