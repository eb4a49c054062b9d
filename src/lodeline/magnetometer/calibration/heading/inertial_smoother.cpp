#include "lodeline/magnetometer/calibration/heading/inertial_smoother.h"

#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

/// Angular rate of the body during gaps in the gyroscope's readings, rad/s, one sigma.
constexpr double kUnmeasuredRate = 0.5;
constexpr size_t kFewestMoments = 30;

/// Attitude of the body at the first reading, from the mean directions of up and field.
Quat worldFromStart(const Vec3& up_S, const Vec3& field_S) {
  Mat3 start_from_world;
  const Vec3 east_S = field_S.cross(up_S).normalized();
  start_from_world << east_S, up_S.normalized().cross(east_S), up_S.normalized();
  return Quat(start_from_world.transpose());
}

}  // namespace

InertialSmoother::InertialSmoother(std::span<const NormalizedFieldSample> field,
                                   std::span<const ImuSample> imu, const InertialParameters& start,
                                   const InertialCalibrationOptions& options)
    : imu_(imu), options_(options), parameters_(start) {
  const GyroscopePath path(imu, start.gyroscope_bias_B);
  makeMoments(field, path);
  if (moments_.size() < kFewestMoments) {
    throw EstimationError("fewer than 30 magnetometer readings lie within the IMU's");
  }
  orient(path);
}

void InertialSmoother::makeMoments(std::span<const NormalizedFieldSample> field, const GyroscopePath& path) {
  // The time offset still changes a little; without a margin, readings at the ends would exceed the IMU's
  // time span.
  const Duration margin = Duration::fromSeconds(0.02);
  const Duration offset = Duration::fromSeconds(parameters_.time_offset_s);
  std::vector<NormalizedFieldSample> inside;
  for (const NormalizedFieldSample& sample : field) {
    if (path.covers(sample.time + offset - margin) && path.covers(sample.time + offset + margin)) {
      inside.push_back(sample);
    }
  }
  if (inside.empty()) return;
  const double length_s = (inside.back().time - inside.front().time).seconds();
  const double group_s = std::max(options_.least_moment_s, length_s / options_.most_moments);
  size_t begin = 0;
  for (size_t end = 1; end <= inside.size(); ++end) {
    // Half a microsecond, because stamps with equal spacing are rounded.
    if (end < inside.size() && (inside[end].time - inside[begin].time).seconds() < group_s - 5e-7) continue;
    Moment moment;
    const double share = 1.0 / static_cast<double>(end - begin);
    double since_first_s = 0.0;
    for (size_t i = begin; i < end; ++i) {
      moment.reading += share * inside[i].field_M;
      moment.stamps.push_back(inside[i].time);
      since_first_s += share * (inside[i].time - inside[begin].time).seconds();
    }
    moment.stamp = inside[begin].time + Duration::fromSeconds(since_first_s);
    moments_.push_back(std::move(moment));
    begin = end;
  }
}

void InertialSmoother::orient(const GyroscopePath& path) {
  const Duration offset = Duration::fromSeconds(parameters_.time_offset_s);
  const Mat3 correction = parameters_.soft_iron.inverse();
  Vec3 up_S = Vec3::Zero();
  Vec3 field_S = Vec3::Zero();
  for (const Moment& moment : moments_) {
    const GyroscopePath::Point point = path.at(moment.stamp + offset);
    up_S += point.start_from_body * point.specific_force_B;
    field_S += point.start_from_body *
               (parameters_.body_from_magnetometer * (correction * (moment.reading - parameters_.hard_iron)));
  }
  if (!(up_S.cross(field_S).norm() > 1e-3 * up_S.norm() * field_S.norm())) {
    throw EstimationError("accelerometer and magnetometer point the same way: no heading at this place");
  }
  parameters_.dip_rad = std::asin(std::clamp(-up_S.normalized().dot(field_S.normalized()), -1.0, 1.0));
  const Quat world_from_start = worldFromStart(up_S, field_S);
  for (const Moment& moment : moments_) {
    world_from_body_.push_back(
        (world_from_start * path.at(moment.stamp + offset).start_from_body).normalized());
  }
  terms_.resize(moments_.size());
}

void InertialSmoother::linearize() {
  const GyroscopePath path(imu_, parameters_.gyroscope_bias_B);
  const Duration offset = Duration::fromSeconds(parameters_.time_offset_s);
  std::vector<GyroscopePath::Point> points;
  for (const Moment& moment : moments_) points.push_back(path.at(moment.stamp + offset));
  for (size_t k = 0; k < moments_.size(); ++k) {
    const Moment& moment = moments_[k];
    Terms& terms = terms_[k];
    Mat3 mean_turn = Mat3::Identity();
    if (moment.stamps.size() > 1) {
      mean_turn.setZero();
      for (const Time stamp : moment.stamps) {
        const Quat turn = path.at(stamp + offset).start_from_body.conjugate() * points[k].start_from_body;
        mean_turn += turn.toRotationMatrix() / static_cast<double>(moment.stamps.size());
      }
    }
    terms.field =
        fieldResidual(moment.reading, mean_turn, points[k].rate_B, world_from_body_[k], parameters_);
    terms.gravity = gravityResidual(points[k].specific_force_B, world_from_body_[k], parameters_);
    if (k + 1 == moments_.size()) break;
    const Quat turn = points[k].start_from_body.conjugate() * points[k + 1].start_from_body;
    const Mat3 by_bias = points[k + 1].by_bias - turn.toRotationMatrix().transpose() * points[k].by_bias;
    terms.turn = turnResidual(turn, by_bias, world_from_body_[k], world_from_body_[k + 1]);
    terms.step_s = (moments_[k + 1].stamp - moment.stamp).seconds();
    terms.gap_s = path.gap_s(moment.stamp + offset, moments_[k + 1].stamp + offset);
  }
}

double InertialSmoother::turnSigma(const Terms& terms, const SmootherNoise& noise) const {
  return std::hypot(noise.gyroscope_density * std::sqrt(terms.step_s), kUnmeasuredRate * terms.gap_s);
}

InertialSmoother::Chain InertialSmoother::equations(const SmootherNoise& noise) const {
  Chain chain(moments_.size());
  for (size_t k = 0; k < moments_.size(); ++k) {
    const Terms& t = terms_[k];
    if (moments_[k].used) {
      const double w = std::sqrt(static_cast<double>(moments_[k].stamps.size())) / noise.reading_sigma;
      chain.addUnary(k, w * t.field.value, w * t.field.by_rotation, w * t.field.by_parameters);
    }
    const double spacing_s = std::max(t.step_s, options_.least_moment_s);
    // Moments with a spacing below the correlation time of the accelerations count as one.
    const double w = std::min(1.0, std::sqrt(spacing_s / (2.0 * options_.acceleration_correlation_s))) /
                     noise.acceleration_sigma;
    chain.addUnary(k, w * t.gravity.value, w * t.gravity.by_rotation, w * t.gravity.by_parameters);
    if (k + 1 == moments_.size()) break;
    const double v = 1.0 / turnSigma(t, noise);
    Chain::Border by_parameters = Chain::Border::Zero();
    by_parameters.middleCols<3>(inertial_parameter::kGyroscopeBias) = v * t.turn.by_bias;
    chain.addBinary(k, v * t.turn.value, v * t.turn.by_first, v * t.turn.by_second, by_parameters);
  }
  for (int i = 0; i < 3; ++i) {
    chain.addPrior(inertial_parameter::kAccelerometerBias + i, parameters_.accelerometer_bias_B[i],
                   options_.accelerometer_bias_sigma_m_per_s2);
  }
  return chain;
}

double InertialSmoother::logSigmas(const SmootherNoise& noise) const {
  double sum = 0.0;
  for (size_t k = 0; k < moments_.size(); ++k) {
    if (moments_[k].used) sum += 3.0 * std::log(noise.reading_sigma);
    if (k + 1 < moments_.size()) sum += 3.0 * std::log(turnSigma(terms_[k], noise));
  }
  return sum;
}

void InertialSmoother::step(const Eigen::Matrix<double, inertial_parameter::kSize, 1>& parameters,
                            const std::vector<Vec3>& rotations) {
  parameters_ = moved(parameters_, parameters);
  for (size_t k = 0; k < rotations.size(); ++k) {
    world_from_body_[k] = (world_from_body_[k] * so3::exp(rotations[k])).normalized();
  }
}

double InertialSmoother::accelerationRms() const {
  double square = 0.0;
  for (const Terms& terms : terms_) square += terms.gravity.value.squaredNorm() / 3.0;
  return std::sqrt(square / static_cast<double>(terms_.size()));
}

}  // namespace lodeline
