#include "lodeline/ahrs/gyroscope_bias_filter.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

/// Standard deviation of a component without measurement.
constexpr double kNothingMeasured = 1e6;

}  // namespace

GyroscopeBiasFilter::GyroscopeBiasFilter(const GyroscopeBiasOptions& options,
                                         double inclination_time_constant_s)
    : options_(options),
      covariance_(options.initial_sigma_rad_per_s * options.initial_sigma_rad_per_s * Mat3::Identity()),
      delayed_attitude_(inclination_time_constant_s),
      delayed_bias_W_(inclination_time_constant_s) {}

void GyroscopeBiasFilter::follow(const Mat3& world_from_body, double step_s) {
  delayed_attitude_.update(world_from_body, step_s);
  delayed_bias_W_.update(world_from_body * bias_B_, step_s);
  since_start_s_ += step_s;
}

void GyroscopeBiasFilter::restart() {
  delayed_attitude_.reset();
  delayed_bias_W_.reset();
  since_start_s_ = 0.0;
}

bool GyroscopeBiasFilter::updateAtRest(const Vec3& mean_rate_B, double step_s) {
  const Vec3 innovation = mean_rate_B - bias_B_;
  const Vec3 allowed =
      3.0 * covariance_.diagonal().cwiseSqrt() + Vec3::Constant(options_.slow_turn_rad_per_s);
  if ((innovation.cwiseAbs().array() > allowed.array()).any() ||
      mean_rate_B.cwiseAbs().maxCoeff() > options_.largest_rad_per_s) {
    return false;
  }
  predict(step_s);
  const double density = options_.rest_density_rad_per_s_sqrtHz;
  correct(innovation, Mat3::Identity(), Vec3::Constant(density * density / step_s));
  return true;
}

void GyroscopeBiasFilter::updateInMotion(const Vec3& correction_W, double step_s) {
  predict(step_s);
  // Without a bias error, the accelerometer would not correct the inclination. Its correction per second
  // equals the error of the bias that was used when the delayed acceleration was measured.
  const Mat3& model = delayed_attitude_.value();
  Vec3 innovation = delayed_bias_W_.value() - correction_W / step_s - model * bias_B_;
  innovation.z() = 0.0;
  const double unsettled = options_.settling_s / std::max(since_start_s_, step_s);
  const double density = options_.motion_density_rad_per_s_sqrtHz * std::sqrt(1.0 + unsettled * unsettled);
  const double variance = density * density / step_s;
  correct(innovation, model, Vec3(variance, variance, kNothingMeasured));
}

void GyroscopeBiasFilter::predict(double step_s) {
  const double forgotten = options_.forgotten_sigma_rad_per_s;
  covariance_.diagonal().array() += forgotten * forgotten * step_s / options_.forgetting_s;
}

void GyroscopeBiasFilter::correct(const Vec3& innovation, const Mat3& model, const Vec3& variance) {
  Mat3 total = model * covariance_ * model.transpose();
  total.diagonal() += variance;
  const Mat3 gain = covariance_ * model.transpose() * total.inverse();
  bias_B_ += gain * innovation;
  const double largest = options_.largest_rad_per_s;
  bias_B_ = bias_B_.cwiseMax(-largest).cwiseMin(largest);
  const Mat3 reduced = (Mat3::Identity() - gain * model) * covariance_;
  covariance_ = 0.5 * (reduced + reduced.transpose());
}

}  // namespace lodeline
