#pragma once

#include <span>
#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/imu/rotation_increment.h"
#include "lodeline/imu/step_noise.h"
#include "lodeline/rig.h"
#include "lodeline/types.h"

namespace lodeline {

struct PreintegrationOptions {
  /// Factor on all four densities of ImuNoise. Datasheet and Allan values apply to a sensor at rest on a
  /// bench.
  double noise_inflation = 2.0;
  MotionNoiseOptions motion_noise;

  /// Two readings with a longer interval, also longer than 1.5 nominal periods, count as lost data.
  double max_gap_s = 0.02;
  /// Difference between the mean rate and specific force over a gap and the mean of its two ends, one sigma
  /// per axis.
  double gap_rate_sigma_rad_per_s = 0.3;
  double gap_specific_force_sigma_m_per_s2 = 1.5;

  /// Limits of the first-order bias correction: |db_g| * dt and |db_a| * dt. alpha and beta are linear in
  /// b_a, so the second limit only bounds the product of both.
  double max_rotation_correction_rad = 0.005;
  double max_velocity_correction_m_per_s = 0.1;
};

/// First index of each part in the 15 coordinates of the inertial error, its covariance and the residual.
namespace inertial_error {
constexpr int kAlpha = 0;               ///< m, axes of body k
constexpr int kBeta = 3;                ///< m/s, axes of body k
constexpr int kTheta = 6;               ///< rad, axes of body k
constexpr int kGyroscopeBias = 9;       ///< rad/s
constexpr int kAccelerometerBias = 12;  ///< m/s^2
constexpr int kRelativeMotionSize = 9;  ///< alpha, beta, theta
constexpr int kSize = 15;
}  // namespace inertial_error

/// Relative motion from body k to body k+1 measured by the IMU, independent of gravity and of the state at k:
///   R_B_W^k (p^{k+1} - p^k - v^k dt - g dt^2 / 2) = alpha
///   R_B_W^k (v^{k+1} - v^k - g dt)                = beta
///   R_B_W^k R_W_B^{k+1}                           = gamma
struct RelativeMotion {
  Vec3 alpha = Vec3::Zero();      ///< m, axes of body k
  Vec3 beta = Vec3::Zero();       ///< m/s, axes of body k
  Quat gamma = Quat::Identity();  ///< body_k from body_k+1
};

/// Rotation from the start of an interval to a moment within it, with its derivative by the gyroscope bias:
/// gamma(b_g + d) = exp(theta_by_gyroscope_bias * d) * gamma(b_g).
struct IntermediateRotation {
  Quat gamma = Quat::Identity();  ///< body_k from body at that moment
  Mat3 theta_by_gyroscope_bias = Mat3::Zero();

  Quat correctedFor(const Vec3& gyroscope_bias_change) const;
};

struct ImuAxes {
  SensorAxes gyroscope = SensorAxes::Zero();
  SensorAxes accelerometer = SensorAxes::Zero();
};

/// Preintegrated IMU readings between two moments k and k+1.
///
/// Model: measured rate = true rate + b_g + noise, measured force = R_B_W (a_W - g_W) + b_a + noise. White
/// noise and random walks of the biases have the densities of ImuNoise times `noise_inflation`, and more in
/// motion (imu/step_noise.h). Over a step the rate is a cubic in time. Its slopes at the readings are those
/// of the chords between their neighbours (rotation by the Magnus expansion to second order). The specific
/// force, rotated into body k's axes, is linear in time.
///
/// Error: e = [alpha, beta, theta, b_g, b_a] = truth minus integration with the biases of moment k, with
/// gamma_true = exp(theta) * gamma. The last two parts are the random walk of the biases from k to k+1.
///
/// Sources: Forster et al., "On-manifold preintegration for real-time visual-inertial odometry", TRO 2017
/// (bias correction); Qin, Li & Shen, "VINS-Mono", TRO 2018 (alpha, beta, gamma). Derivation:
/// docs/theory/inertial.md.
class Preintegration {
 public:
  using Mat15 = Eigen::Matrix<double, 15, 15>;
  using Mat96 = Eigen::Matrix<double, 9, 6>;
  using Mat99 = Eigen::Matrix<double, 9, 9>;

  /// `samples`: readings from moment k to moment k+1 with strictly increasing times; the first and last one
  /// are exactly at k and k+1. Throws InputError for fewer than two samples, times that do not increase,
  /// readings that are not finite, or noise densities that are not positive.
  Preintegration(std::span<const ImuSample> samples, const Vec3& gyroscope_bias_B,
                 const Vec3& accelerometer_bias_B, const ImuCalibration& imu,
                 const PreintegrationOptions& options = {});

  Time start() const { return samples_.front().time; }
  Time end() const { return samples_.back().time; }
  double dt_s() const { return (end() - start()).seconds(); }

  /// The biases used for integration.
  const Vec3& gyroscopeBias() const { return gyroscope_bias_; }
  const Vec3& accelerometerBias() const { return accelerometer_bias_; }

  /// Relative motion for the biases used for integration and calibrated axes.
  const RelativeMotion& motion() const { return motion_; }
  /// Relative motion for other biases and axes, to first order.
  RelativeMotion correctedFor(const Vec3& gyroscope_bias_B, const Vec3& accelerometer_bias_B,
                              const ImuAxes& axes = {}) const;
  /// d[alpha, beta, theta] / d[b_g, b_a], theta as in IntermediateRotation.
  const Mat96& biasJacobian() const { return bias_jacobian_; }
  /// d[alpha, beta, theta] by the axes of the gyroscope and of the accelerometer.
  const Mat99& gyroscopeAxesJacobian() const { return gyroscope_axes_jacobian_; }
  const Mat99& accelerometerAxesJacobian() const { return accelerometer_axes_jacobian_; }

  /// Covariance of the error e, SI units.
  const Mat15& covariance() const { return covariance_; }
  /// Lower triangular W with W^T W = covariance^-1: W * e has unit covariance.
  const Mat15& whitening() const { return whitening_; }

  bool needsRepropagation(const Vec3& gyroscope_bias_B, const Vec3& accelerometer_bias_B) const;
  /// Integrates again with the given biases.
  void repropagate(const Vec3& gyroscope_bias_B, const Vec3& accelerometer_bias_B);

  /// Integrates again with inflated noise.
  void setDoubt(const InertialDoubt& doubt);
  const InertialDoubt& doubt() const { return doubt_; }

  /// Rotation from body k to the body at `time`, for the bias used for integration. Throws InputError outside
  /// the interval.
  IntermediateRotation gammaAt(Time time) const;

 private:
  void integrate();
  /// Integrates the step from sample i to the next.
  void advance(size_t i);
  /// Rate at sample i, corrected for the bias.
  TurningRate turningRate(size_t i) const;
  Mat15 processNoise(const ImuSample& from, const ImuSample& to,
                     const Eigen::Matrix<double, 9, 3>& motion_by_gyroscope_bias) const;

  std::vector<ImuSample> samples_;
  ImuCalibration imu_;
  PreintegrationOptions options_;
  InertialDoubt doubt_;
  Vec3 gyroscope_bias_;
  Vec3 accelerometer_bias_;

  RelativeMotion motion_;
  Mat96 bias_jacobian_;
  Mat99 gyroscope_axes_jacobian_;
  Mat99 accelerometer_axes_jacobian_;
  Mat15 covariance_;
  Mat15 whitening_;
  std::vector<IntermediateRotation> rotations_;  // at each sample
};

}  // namespace lodeline
