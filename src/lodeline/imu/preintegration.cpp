#include "lodeline/imu/preintegration.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/imu/rotation_increment.h"
#include "lodeline/imu/sample_check.h"

namespace lodeline {
namespace {

using namespace inertial_error;

// One step between two readings; index 0 is its start, 1 its end. Axes of body k.
struct Step {
  double h;  // s
  Mat3 rotation_0, rotation_1;
  Vec3 force_0, force_1;
  Mat3 theta_by_bias;  // derivative by the gyroscope bias of the change of theta over the step
};

// Derivative of the integration over one step: force_i changes by theta_i x force_i - rotation_i b_a, and
// theta_1 = theta_0 + theta_by_bias b_g.
Preintegration::Mat15 errorTransition(const Step& step) {
  const double h = step.h;
  const Mat3 force_0_by_theta = -so3::skew(step.force_0);
  const Mat3 force_1_by_theta = -so3::skew(step.force_1);
  Preintegration::Mat15 f = Preintegration::Mat15::Identity();
  f.block<3, 3>(kAlpha, kBeta).diagonal().setConstant(h);
  f.block<3, 3>(kAlpha, kTheta) = h * h * (force_0_by_theta / 3.0 + force_1_by_theta / 6.0);
  f.block<3, 3>(kBeta, kTheta) = 0.5 * h * (force_0_by_theta + force_1_by_theta);
  f.block<3, 3>(kAlpha, kGyroscopeBias) = h * h / 6.0 * force_1_by_theta * step.theta_by_bias;
  f.block<3, 3>(kBeta, kGyroscopeBias) = 0.5 * h * force_1_by_theta * step.theta_by_bias;
  f.block<3, 3>(kTheta, kGyroscopeBias) = step.theta_by_bias;
  f.block<3, 3>(kAlpha, kAccelerometerBias) = -h * h * (step.rotation_0 / 3.0 + step.rotation_1 / 6.0);
  f.block<3, 3>(kBeta, kAccelerometerBias) = -0.5 * h * (step.rotation_0 + step.rotation_1);
  return f;
}

Vec3 chordSlope(const ImuSample& from, const ImuSample& to) {
  return (to.angular_velocity_B - from.angular_velocity_B) / (to.time - from.time).seconds();
}

/// Rate within a step of length `step_s`, on the cubic through its ends.
TurningRate interpolated(const TurningRate& from, const TurningRate& to, double step_s, double fraction) {
  const Vec3 mean_slope = (to.rate_rad_per_s - from.rate_rad_per_s) / step_s;
  const Vec3 a = from.slope_rad_per_s2 - mean_slope;
  const Vec3 b = to.slope_rad_per_s2 - mean_slope;
  const double u = fraction, v = 1.0 - fraction;
  return {v * from.rate_rad_per_s + u * to.rate_rad_per_s + step_s * u * v * (v * a - u * b),
          mean_slope + v * (v - 2.0 * u) * a + u * (u - 2.0 * v) * b};
}

IntermediateRotation turned(const IntermediateRotation& rotation, const RotationIncrement& increment) {
  IntermediateRotation result;
  result.gamma = (rotation.gamma * so3::exp(increment.rotation_vector)).normalized();
  result.theta_by_gyroscope_bias =
      rotation.theta_by_gyroscope_bias +
      rotation.gamma.toRotationMatrix() * so3::leftJacobian(increment.rotation_vector) * increment.by_bias;
  return result;
}

void requirePositive(const ImuNoise& noise, double inflation) {
  for (const double factor :
       {noise.gyroscope_density_rad_per_s_sqrtHz, noise.gyroscope_random_walk_rad_per_s2_sqrtHz,
        noise.accelerometer_density_m_per_s2_sqrtHz, noise.accelerometer_random_walk_m_per_s3_sqrtHz,
        inflation}) {
    if (!(factor > 0.0) || !std::isfinite(factor)) {
      throw InputError(
          fmt::format("IMU noise: every density and the inflation must be positive, but one is {}; give the "
                      "datasheet's figures",
                      factor));
    }
  }
}

}  // namespace

Quat IntermediateRotation::correctedFor(const Vec3& gyroscope_bias_change) const {
  return (so3::exp(theta_by_gyroscope_bias * gyroscope_bias_change) * gamma).normalized();
}

Preintegration::Preintegration(std::span<const ImuSample> samples, const Vec3& gyroscope_bias_B,
                               const Vec3& accelerometer_bias_B, const ImuCalibration& imu,
                               const PreintegrationOptions& options)
    : samples_(samples.begin(), samples.end()), imu_(imu), options_(options) {
  requireUsable(samples);
  requirePositive(imu.noise, options.noise_inflation);
  rotations_.reserve(samples_.size());
  repropagate(gyroscope_bias_B, accelerometer_bias_B);
}

void Preintegration::repropagate(const Vec3& gyroscope_bias_B, const Vec3& accelerometer_bias_B) {
  gyroscope_bias_ = gyroscope_bias_B;
  accelerometer_bias_ = accelerometer_bias_B;
  integrate();
}

void Preintegration::setDoubt(const InertialDoubt& doubt) {
  doubt_ = doubt;
  integrate();
}

bool Preintegration::needsRepropagation(const Vec3& gyroscope_bias_B,
                                        const Vec3& accelerometer_bias_B) const {
  return (gyroscope_bias_B - gyroscope_bias_).norm() * dt_s() > options_.max_rotation_correction_rad ||
         (accelerometer_bias_B - accelerometer_bias_).norm() * dt_s() >
             options_.max_velocity_correction_m_per_s;
}

RelativeMotion Preintegration::correctedFor(const Vec3& gyroscope_bias_B, const Vec3& accelerometer_bias_B,
                                            const ImuAxes& axes) const {
  Eigen::Matrix<double, 6, 1> change;
  change << gyroscope_bias_B - gyroscope_bias_, accelerometer_bias_B - accelerometer_bias_;
  const Eigen::Matrix<double, 9, 1> correction = bias_jacobian_ * change +
                                                 gyroscope_axes_jacobian_ * axes.gyroscope +
                                                 accelerometer_axes_jacobian_ * axes.accelerometer;
  RelativeMotion corrected;
  corrected.alpha = motion_.alpha + correction.segment<3>(kAlpha);
  corrected.beta = motion_.beta + correction.segment<3>(kBeta);
  corrected.gamma = (so3::exp(correction.segment<3>(kTheta)) * motion_.gamma).normalized();
  return corrected;
}

void Preintegration::integrate() {
  motion_ = {};
  bias_jacobian_.setZero();
  gyroscope_axes_jacobian_.setZero();
  accelerometer_axes_jacobian_.setZero();
  covariance_.setZero();
  rotations_.assign(1, IntermediateRotation());
  for (size_t i = 0; i + 1 < samples_.size(); ++i) advance(i);
  covariance_.diagonal().segment<3>(kGyroscopeBias).array() +=
      doubt_.gyroscope_bias_step_rad_per_s * doubt_.gyroscope_bias_step_rad_per_s;
  covariance_.diagonal().segment<3>(kAccelerometerBias).array() +=
      doubt_.accelerometer_bias_step_m_per_s2 * doubt_.accelerometer_bias_step_m_per_s2;

  whitening_.setIdentity();
  covariance_.llt().matrixL().solveInPlace(whitening_);
}

TurningRate Preintegration::turningRate(size_t i) const {
  // Slope at a reading. At the ends of the interval, it is the one-sided chord: higher orders amplify
  // vibration and uneven stamps more than they gain.
  const ImuSample& before = samples_[i == 0 ? 0 : i - 1];
  const ImuSample& after = samples_[i + 1 == samples_.size() ? i : i + 1];
  return {samples_[i].angular_velocity_B - gyroscope_bias_, chordSlope(before, after)};
}

void Preintegration::advance(size_t i) {
  const ImuSample& from = samples_[i];
  const ImuSample& to = samples_[i + 1];
  Step step;
  step.h = (to.time - from.time).seconds();
  const RotationIncrement increment(turningRate(i), turningRate(i + 1), step.h);
  step.rotation_0 = motion_.gamma.toRotationMatrix();
  step.theta_by_bias = step.rotation_0 * so3::leftJacobian(increment.rotation_vector) * increment.by_bias;
  rotations_.push_back(turned(rotations_.back(), increment));
  motion_.gamma = rotations_.back().gamma;
  step.rotation_1 = motion_.gamma.toRotationMatrix();
  step.force_0 = step.rotation_0 * (from.specific_force_B - accelerometer_bias_);
  step.force_1 = step.rotation_1 * (to.specific_force_B - accelerometer_bias_);

  // Integrals of a force that varies linearly from force_0 to force_1.
  motion_.alpha += step.h * motion_.beta + step.h * step.h * (step.force_0 / 3.0 + step.force_1 / 6.0);
  motion_.beta += 0.5 * step.h * (step.force_0 + step.force_1);

  const Mat15 transition = errorTransition(step);
  bias_jacobian_ =
      (transition.topLeftCorner<9, 9>() * bias_jacobian_ + transition.topRightCorner<9, 6>()).eval();
  const Eigen::Matrix<double, 9, 3> motion_by_rate = -transition.block<9, 3>(kAlpha, kGyroscopeBias);
  gyroscope_axes_jacobian_ = (transition.topLeftCorner<9, 9>() * gyroscope_axes_jacobian_).eval();
  accelerometer_axes_jacobian_ = (transition.topLeftCorner<9, 9>() * accelerometer_axes_jacobian_).eval();
  for (int column = 0; column < 3; ++column) {
    gyroscope_axes_jacobian_.middleCols<3>(3 * column) +=
        increment.mean_rate_rad_per_s[column] * motion_by_rate;
    const Mat3 by_0 = (from.specific_force_B - accelerometer_bias_)[column] * step.rotation_0;
    const Mat3 by_1 = (to.specific_force_B - accelerometer_bias_)[column] * step.rotation_1;
    auto by_column = accelerometer_axes_jacobian_.middleCols<3>(3 * column);
    by_column.middleRows<3>(kAlpha) += step.h * step.h * (by_0 / 3.0 + by_1 / 6.0);
    by_column.middleRows<3>(kBeta) += 0.5 * step.h * (by_0 + by_1);
  }
  covariance_ = (transition * covariance_ * transition.transpose() +
                 processNoise(from, to, transition.block<9, 3>(kAlpha, kGyroscopeBias)))
                    .eval();
}

Preintegration::Mat15 Preintegration::processNoise(
    const ImuSample& from, const ImuSample& to,
    const Eigen::Matrix<double, 9, 3>& motion_by_gyroscope_bias) const {
  const double h = (to.time - from.time).seconds();
  StepNoise noise =
      stepNoise(from, to, gyroscope_bias_, imu_.noise, options_.noise_inflation, options_.motion_noise);
  const double gap_s = std::max(h, to.gap_s);
  if (gap_s > std::max(options_.max_gap_s, 1.5 / imu_.rate_hz)) {
    // White noise of density sigma * sqrt(h) has, over the gap, a mean with exactly that sigma. In a gap
    // divided by images, the parts have equal errors for the duration of a motion.
    constexpr double kMotion_s = 0.2;
    const double alike_s = std::max(h, std::min(gap_s, kMotion_s));
    noise.gyroscope += alike_s * options_.gap_rate_sigma_rad_per_s * options_.gap_rate_sigma_rad_per_s;
    noise.accelerometer +=
        alike_s * options_.gap_specific_force_sigma_m_per_s2 * options_.gap_specific_force_sigma_m_per_s2;
  }
  noise.gyroscope += doubt_.gyroscope_density_rad_per_s_sqrtHz * doubt_.gyroscope_density_rad_per_s_sqrtHz;
  noise.accelerometer +=
      doubt_.accelerometer_density_m_per_s2_sqrtHz * doubt_.accelerometer_density_m_per_s2_sqrtHz;

  Mat15 q = Mat15::Zero();
  // The gyroscope's noise acts like its bias; its mean over the step has variance density^2 / h.
  q.topLeftCorner<9, 9>() =
      noise.gyroscope / h * motion_by_gyroscope_bias * motion_by_gyroscope_bias.transpose();
  // Exact for white noise on the force, and of full rank even for an interval of one step.
  q.block<3, 3>(kAlpha, kAlpha).diagonal().array() += noise.accelerometer * h * h * h / 3.0;
  q.block<3, 3>(kAlpha, kBeta).diagonal().array() += noise.accelerometer * h * h / 2.0;
  q.block<3, 3>(kBeta, kAlpha).diagonal().array() += noise.accelerometer * h * h / 2.0;
  q.block<3, 3>(kBeta, kBeta).diagonal().array() += noise.accelerometer * h;
  q.diagonal().segment<3>(kGyroscopeBias).array() = h * noise.gyroscope_walk;
  q.diagonal().segment<3>(kAccelerometerBias).array() = h * noise.accelerometer_walk;
  return q;
}

IntermediateRotation Preintegration::gammaAt(Time time) const {
  if (time < start() || time > end()) {
    throw InputError(
        fmt::format("rotation asked for at {} ns, outside the preintegrated interval {} to {} ns",
                    time.nanoseconds(), start().nanoseconds(), end().nanoseconds()));
  }
  const auto later = std::lower_bound(samples_.begin(), samples_.end(), time,
                                      [](const ImuSample& sample, Time t) { return sample.time < t; });
  const size_t i = static_cast<size_t>(later - samples_.begin());
  if (later->time == time) return rotations_[i];

  const double stretch_s = (time - samples_[i - 1].time).seconds();
  const double step_s = (later->time - samples_[i - 1].time).seconds();
  const TurningRate from = turningRate(i - 1);
  const TurningRate then = interpolated(from, turningRate(i), step_s, stretch_s / step_s);
  return turned(rotations_[i - 1], RotationIncrement(from, then, stretch_s));
}

}  // namespace lodeline
