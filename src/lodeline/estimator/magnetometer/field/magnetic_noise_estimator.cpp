#include "lodeline/estimator/magnetometer/field/magnetic_noise_estimator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lodeline/ahrs/field_gate.h"

namespace lodeline {
namespace {

constexpr double kLeastFloor_T = 4e-9, kFloorStep = std::numbers::sqrt2;
constexpr int kFloors = 17;
constexpr double kLeastWalk_T_per_sqrt_s = 1e-10, kWalkStep = 3.0;
constexpr int kWalks = 4;
constexpr double kEarthSigma_T = 1e-5;  // of size and dip at the start

double logPrior(double size, double root_mean_square) {
  const double spread = std::log(MagneticNoiseEstimator::kPriorFactor);
  // The root mean square of a log-normal variable exceeds its median by exp(spread^2).
  return -0.5 * std::pow((std::log(size / root_mean_square) + spread * spread) / spread, 2);
}

}  // namespace

MagneticNoiseEstimator::MagneticNoiseEstimator(const MagnetometerOptions& options, double offset_sigma_T)
    : options_(options) {
  for (int floor = 0; floor < kFloors; ++floor) {
    for (int walk = 0; walk < kWalks; ++walk) {
      Model model;
      model.correlated_noise_sigma_T = kLeastFloor_T * std::pow(kFloorStep, floor);
      model.walk_T_per_sqrt_s = kLeastWalk_T_per_sqrt_s * std::pow(kWalkStep, walk);
      model.log_prior = logPrior(model.correlated_noise_sigma_T, options.correlated_noise_sigma_T) +
                        logPrior(model.walk_T_per_sqrt_s, options.offset_walk_T_per_sqrt_s);
      model.covariance.diagonal() << Vec3::Constant(offset_sigma_T * offset_sigma_T),
          Vec2::Constant(kEarthSigma_T * kEarthSigma_T),
          Vec2::Constant(model.correlated_noise_sigma_T * model.correlated_noise_sigma_T);
      models_.push_back(model);
    }
  }
  weigh();
}

void MagneticNoiseEstimator::add(const MagnetometerMean& mean, const Quat& world_from_body,
                                 const Vec3& offset_B, double white_variance_T2,
                                 const TimeCorrelatedError& tilt) {
  if (sums_ && (mean.time - sums_->begin).seconds() >= interval_s()) learn(mean.time);
  const Mat3 world_from_sensed = world_from_body * mean.carried;
  const Vec3 field_W = world_from_body * (mean.field_B - mean.carried * offset_B);
  const FieldShape shape = FieldShape::of(field_W);
  if (size_T_ == 0.0) {
    size_T_ = shape.norm_T;
    for (Model& model : models_) model.state.segment<2>(3) << size_T_, size_T_ * shape.dip_rad;
  }
  const Vec3 along = field_W.normalized();
  const Vec3 across = Vec3::UnitZ().cross(field_W).normalized();  // zero at a magnetic pole
  Derivative derivative;
  derivative << along.transpose() * world_from_sensed, Eigen::RowVector4d(1.0, 0.0, 1.0, 0.0),
      across.cross(along).transpose() * world_from_sensed, Eigen::RowVector4d(0.0, 1.0, 0.0, 1.0);
  if (!sums_) sums_ = Sums{mean.time};
  ++sums_->readings;
  sums_->derivative += derivative;
  sums_->measured_T += Vec2(shape.norm_T, size_T_ * shape.dip_rad) + derivative.leftCols<3>() * offset_B;
  sums_->white_variance_T2 += white_variance_T2;
  sums_->tilt_variance_rad2 += tilt.variance * std::max(1.0, 2.0 * tilt.correlation_s / interval_s());
}

void MagneticNoiseEstimator::learn(Time now) {
  const double since_s = updated_ ? (now - *updated_).seconds() : 0.0;
  for (Model& model : models_) {
    predict(since_s, &model);
    update(*sums_, &model);
  }
  weigh();
  updated_ = now;
  sums_.reset();
}

void MagneticNoiseEstimator::predict(double since_s, Model* model) const {
  const double kept = std::exp(-since_s / options_.correlated_noise_time_s);
  const double correlated_noise_sigma_T2 = model->correlated_noise_sigma_T * model->correlated_noise_sigma_T;
  model->state.tail<2>() *= kept;
  model->covariance.rightCols<2>() *= kept;
  model->covariance.bottomRows<2>() *= kept;
  model->covariance.diagonal().tail<2>().array() += (1.0 - kept * kept) * correlated_noise_sigma_T2;
  model->covariance.diagonal().head<3>().array() += std::pow(model->walk_T_per_sqrt_s, 2) * since_s;
  model->log_likelihood *= std::exp(-since_s / options_.correlated_noise_memory_s);
}

void MagneticNoiseEstimator::update(const Sums& sums, Model* model) const {
  const double n = sums.readings;
  for (int i = 0; i < 2; ++i) {
    const State derivative = sums.derivative.row(i).transpose() / n;
    const double tilt_T2 = i == 0 ? 0.0 : size_T_ * size_T_ * sums.tilt_variance_rad2 / n;
    const double noise_T2 = sums.white_variance_T2 / (n * n) + tilt_T2;
    const State spread = model->covariance * derivative;
    const double variance_T2 = derivative.dot(spread) + noise_T2;
    const double innovation_T = sums.measured_T[i] / n - derivative.dot(model->state);
    model->state += spread * (innovation_T / variance_T2);
    model->covariance -= spread * spread.transpose() / variance_T2;
    model->log_likelihood -= 0.5 * (innovation_T * innovation_T / variance_T2 + std::log(variance_T2));
  }
}

void MagneticNoiseEstimator::weigh() {
  double most = -std::numeric_limits<double>::infinity();
  for (const Model& model : models_) most = std::max(most, model.log_prior + model.log_likelihood);
  double sum = 0.0, correlated_noise_sigma_T2 = 0.0, walk_T2_per_s = 0.0;
  for (const Model& model : models_) {
    const double weight = std::exp(model.log_prior + model.log_likelihood - most);
    sum += weight;
    correlated_noise_sigma_T2 += weight * model.correlated_noise_sigma_T * model.correlated_noise_sigma_T;
    walk_T2_per_s += weight * model.walk_T_per_sqrt_s * model.walk_T_per_sqrt_s;
  }
  correlated_noise_sigma_T_ = std::sqrt(correlated_noise_sigma_T2 / sum);
  walk_T_per_sqrt_s_ = std::sqrt(walk_T2_per_s / sum);
}

}  // namespace lodeline
