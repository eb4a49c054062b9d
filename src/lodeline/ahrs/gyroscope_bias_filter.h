#pragma once

#include "lodeline/ahrs/low_pass.h"
#include "lodeline/geometry/types.h"

namespace lodeline {

struct GyroscopeBiasOptions {
  double initial_sigma_rad_per_s = 0.035;  ///< of a turn-on bias, 2 deg/s
  double largest_rad_per_s = 0.17;         ///< 10 deg/s; readings beyond are no bias
  /// Without any measurement the bias is again as uncertain as `forgotten_sigma` after this time.
  double forgetting_s = 100.0;
  double forgotten_sigma_rad_per_s = 1.75e-3;
  /// White noise of the measurements, as a density: bias of one second's worth of them, one sigma.
  double rest_density_rad_per_s_sqrtHz = 1.6e-3;
  double motion_density_rad_per_s_sqrtHz = 0.0175;
  /// After a start in motion the corrections of inclination show the error of the first inclination more than
  /// any bias; their uncertainty is that much larger (over the time since the start) for so long.
  double settling_s = 20.0;
  /// A mean rate at rest is a slow turn, and no bias, when it is further than this from the bias, plus three
  /// sigmas of it.
  double slow_turn_rad_per_s = 5e-3;
};

/// Kalman filter of the gyroscope's bias, in body axes. At rest it measures the bias; in motion it measures
/// the two horizontal components, by how fast the accelerometer has to correct the inclination (Laidig &
/// Seel, "VQF", Information Fusion 2023, section 3.6).
class GyroscopeBiasFilter {
 public:
  /// `inclination_time_constant_s`: of the filter that the correction of inclination went through.
  GyroscopeBiasFilter(const GyroscopeBiasOptions& options, double inclination_time_constant_s);

  /// At rest, with the mean of the gyroscope's readings. False where that is a slow turn and no bias.
  bool updateAtRest(const Vec3& mean_rate_B, double step_s);

  /// In motion: `correction_W` is the turn (rad) by which the accelerometer corrected the attitude in this
  /// step.
  void updateInMotion(const Vec3& correction_W, double step_s);

  /// Keeps up with the delay of the corrections. Every step, before either update.
  void follow(const Mat3& world_from_body, double step_s);

  /// Attitude was lost: forgets the delayed attitudes, not the bias.
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
