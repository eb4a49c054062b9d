#include "lodeline/imu/gravity_alignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/squared.h"
#include "lodeline/imu/gravity.h"
#include "lodeline/imu/rotation_increment.h"
#include "lodeline/imu/sample_check.h"

namespace lodeline {
namespace {

Vec3 mean(const std::vector<Vec3>& values) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// Root mean square over the axes.
double standardDeviation(const std::vector<Vec3>& values) {
  const Vec3 centre = mean(values);
  double sum = 0.0;
  for (const Vec3& value : values) sum += (value - centre).squaredNorm();
  return std::sqrt(sum / (3.0 * static_cast<double>(values.size() - 1)));
}

// Specific forces rotated into the frame of the last reading.
std::vector<Vec3> turnedToLast(std::span<const ImuSample> samples, const Vec3& gyroscope_bias) {
  std::vector<Vec3> forces{samples.front().specific_force_B};
  Quat first_from_body = Quat::Identity();
  for (size_t i = 1; i < samples.size(); ++i) {
    const RotationIncrement increment(samples[i - 1].angular_velocity_B - gyroscope_bias,
                                      samples[i].angular_velocity_B - gyroscope_bias,
                                      (samples[i].time - samples[i - 1].time).seconds());
    first_from_body = (first_from_body * so3::exp(increment.rotation_vector)).normalized();
    forces.push_back(first_from_body * samples[i].specific_force_B);
  }
  for (Vec3& force : forces) force = first_from_body.conjugate() * force;
  return forces;
}

// Variance of the mean force normal to `up`, per axis, estimated from the scatter. Differences of
// neighbouring readings give the white part, which averages out reading by reading. The rest is slow and
// averages out over its correlation time.
double horizontalVarianceOfMean(const std::vector<Vec3>& forces, const Vec3& up, double duration_s,
                                double correlation_s) {
  const Mat32 horizontal = tangentBasis(up);
  const Vec3 centre = mean(forces);
  const double count = static_cast<double>(forces.size());
  double scatter = (horizontal.transpose() * (forces.front() - centre)).squaredNorm();
  double differences = 0.0;
  for (size_t i = 1; i < forces.size(); ++i) {
    scatter += (horizontal.transpose() * (forces[i] - centre)).squaredNorm();
    differences += (horizontal.transpose() * (forces[i] - forces[i - 1])).squaredNorm();
  }
  scatter /= 2.0 * (count - 1.0);
  const double white = differences / (4.0 * (count - 1.0));
  const double slow = std::max(0.0, scatter - white);
  return white / count + slow / (1.0 + duration_s / correlation_s);
}

// Standard deviation of the tilt for a known bias.
double tiltSigma(const std::vector<Vec3>& forces, const Vec3& mean_force, double duration_s, bool still,
                 const GravityAlignmentOptions& options) {
  const double force = mean_force.norm();
  double variance = 0.0;
  if (forces.size() > 1) {
    variance += horizontalVarianceOfMean(forces, mean_force / force, duration_s, options.correlation_s);
  }
  if (!still) {
    // The velocities at both ends are assumed independent.
    variance += std::min(squared(options.acceleration_sigma_m_per_s2),
                         2.0 * squared(options.speed_sigma_m_per_s / duration_s));
  }
  return std::sqrt(variance) / force;
}

void judgeStillness(std::span<const ImuSample> samples, const Vec3& gyroscope_bias,
                    const GravityAlignmentOptions& options, GravityAlignment& result) {
  result.gyroscope_bias_B = gyroscope_bias;
  if (samples.size() == 1) return;
  std::vector<Vec3> rates, forces;
  for (const ImuSample& sample : samples) {
    rates.push_back(sample.angular_velocity_B);
    forces.push_back(sample.specific_force_B);
  }
  result.gyroscope_std_rad_per_s = standardDeviation(rates);
  result.specific_force_std_m_per_s2 = standardDeviation(forces);
  const Vec3 mean_rate = mean(rates);
  const double span_s = (samples.back().time - samples.front().time).seconds();
  result.still = span_s >= options.still_min_span_s &&
                 result.gyroscope_std_rad_per_s < options.still_gyroscope_std_rad_per_s &&
                 result.specific_force_std_m_per_s2 < options.still_specific_force_std_m_per_s2 &&
                 (mean_rate - gyroscope_bias).norm() < options.still_rate_rad_per_s;
  if (result.still) result.gyroscope_bias_B = mean_rate;
}

}  // namespace

Quat levelWithZeroYaw(const Vec3& up_B) {
  constexpr double kSteep = 0.866;  // sine of 60 degrees
  const Vec3 ahead = std::abs(up_B.x()) < kSteep ? Vec3::UnitX() : Vec3::UnitZ();
  const Vec3 east = (ahead - up_B.dot(ahead) * up_B).normalized();
  Mat3 body_from_world;
  body_from_world << east, up_B.cross(east), up_B;
  return so3::canonical(Quat(body_from_world.transpose()));
}

GravityAlignment alignWithGravity(std::span<const ImuSample> samples, const Vec3& gyroscope_bias_B,
                                  const GravityAlignmentOptions& options) {
  requireUsable(samples, 1);
  GravityAlignment result;
  judgeStillness(samples, gyroscope_bias_B, options, result);

  const std::vector<Vec3> forces = turnedToLast(samples, result.gyroscope_bias_B);
  result.mean_specific_force_B = mean(forces);
  const double force = result.mean_specific_force_B.norm();
  if (force < 0.5 * kStandardGravity) {
    throw EstimationError(
        fmt::format("cannot tell which way is up: the specific force from {} to {} ns averages to {:.2f} "
                    "m/s^2, under half "
                    "of gravity; check the accelerometer's unit (m/s^2), or start later",
                    samples.front().time.nanoseconds(), samples.back().time.nanoseconds(), force));
  }
  result.world_from_body = levelWithZeroYaw(result.mean_specific_force_B / force);
  const double duration_s = (samples.back().time - samples.front().time).seconds();
  result.tilt_sigma_rad = tiltSigma(forces, result.mean_specific_force_B, duration_s, result.still, options);
  return result;
}

}  // namespace lodeline
