#include "lodeline/magnetometer/calibration/heading/inertial_calibration.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/calibration/heading/inertial_smoother.h"
#include "lodeline/magnetometer/iron/iron_fit.h"

namespace lodeline {
namespace {

using namespace inertial_parameter;
using Step = Eigen::Matrix<double, kSize, 1>;
using Basis = Eigen::MatrixXd;  // kSize rows

Basis activeBasis(const InertialCalibrationOptions& options, const Mat3& soft_iron, bool with_time_offset) {
  const Basis iron = activeDirections(options.model, soft_iron);  // S and h
  const Eigen::Index iron_columns = iron.cols();
  Basis basis = Basis::Zero(kSize, iron_columns + kSize - kRotation - (with_time_offset ? 0 : 1));
  basis.topLeftCorner(kRotation, iron_columns) = iron;
  Eigen::Index column = iron_columns;
  for (int i = kRotation; i < kSize; ++i) {
    if (i != kTimeOffset || with_time_offset) basis(i, column++) = 1.0;
  }
  return basis;
}

/// Solution of the active parameters' equations, scaled to a unit diagonal.
struct Reduced {
  Step step = Step::Zero();
  double reduction = 0.0;  ///< decrease of the cost
  double log_determinant = 0.0;
};
Reduced solve(const InertialSmoother::Chain::Marginal& marginal, const Basis& active) {
  const Eigen::MatrixXd h = active.transpose() * marginal.information * active;
  const Eigen::VectorXd g = active.transpose() * marginal.gradient;
  const Eigen::VectorXd scale = h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(scale.asDiagonal() * h * scale.asDiagonal());
  const Eigen::VectorXd x = -(scale.asDiagonal() * ldlt.solve(scale.asDiagonal() * g));
  Reduced reduced;
  reduced.step = active * x;
  reduced.reduction = -0.5 * g.dot(x);
  reduced.log_determinant =
      ldlt.vectorD().cwiseMax(1e-300).array().log().sum() - 2.0 * scale.array().log().sum();
  return reduced;
}

class Calibrator {
 public:
  Calibrator(std::span<const NormalizedFieldSample> field, std::span<const ImuSample> imu,
             const ImuNoise& noise, const InertialParameters& start,
             const InertialCalibrationOptions& options)
      : options_(options), smoother_(field, imu, start, options), stated_(noise) {
    noise_.gyroscope_density = noise.gyroscope_density_rad_per_s_sqrtHz;
    smoother_.linearize();
    noise_.reading_sigma = std::max(1e-6, residualRms());
    noise_.acceleration_sigma = std::max(0.02, smoother_.accelerationRms());
  }

  InertialCalibration run() {
    iterate(true);
    estimateNoise(true);
    rejectOutliers();
    iterate(true);
    estimateNoise(true);
    iterate(true);
    InertialCalibration result;
    const Eigen::MatrixXd covariance = covarianceWith(true);
    result.measured_time_offset_s = smoother_.parameters().time_offset_s;
    result.time_offset_sigma_s = std::sqrt(std::max(0.0, covariance(kTimeOffset, kTimeOffset)));
    result.time_offset_significant =
        std::abs(result.measured_time_offset_s) >
        std::max(options_.least_time_offset_s, options_.time_offset_sigmas * result.time_offset_sigma_s);
    if (!result.time_offset_significant) {
      Step step = Step::Zero();
      step[kTimeOffset] = -smoother_.parameters().time_offset_s;
      smoother_.step(step, {});
      iterate(false);
    }
    finish(&result);
    return result;
  }

 private:
  /// Gauss-Newton iterations until the steps vanish.
  void iterate(bool with_time_offset) {
    for (int i = 0; i < options_.max_iterations; ++i) {
      smoother_.linearize();
      InertialSmoother::Chain chain = smoother_.equations(noise_);
      const auto marginal = chain.eliminate();
      const Basis active = activeBasis(options_, smoother_.parameters().soft_iron, with_time_offset);
      const Reduced reduced = solve(marginal, active);
      if (!reduced.step.allFinite() || reduced.step.cwiseAbs().maxCoeff() > 10.0) break;
      smoother_.step(reduced.step, chain.statesFor(reduced.step));
      noise_.acceleration_sigma = std::max(0.02, smoother_.accelerationRms());
      if (reduced.step.head<kDip>().cwiseAbs().maxCoeff() < 1e-7) {
        smoother_.linearize();
        return;
      }
    }
    throw EstimationError("the estimate with gyroscope and accelerometer did not settle");
  }

  /// Negative logarithm of the likelihood with orientations and parameters integrated out.
  double negativeLogLikelihood(const SmootherNoise& noise, const Basis& active) const {
    InertialSmoother::Chain chain = smoother_.equations(noise);
    const double cost = chain.cost();
    const auto marginal = chain.eliminate();
    const Reduced reduced = solve(marginal, active);
    return cost - marginal.reduction - reduced.reduction +
           0.5 * (marginal.log_determinant + reduced.log_determinant) + smoother_.logSigmas(noise);
  }

  /// Minimizes over one noise parameter by golden section search in its logarithm.
  void minimize(double SmootherNoise::*sigma, double least, double greatest, const Basis& active) {
    constexpr double kGolden = 0.618033988749895;
    double a = std::log(least), b = std::log(greatest);
    const auto value = [&](double log_sigma) {
      SmootherNoise noise = noise_;
      noise.*sigma = std::exp(log_sigma);
      return negativeLogLikelihood(noise, active);
    };
    double x = b - kGolden * (b - a), y = a + kGolden * (b - a);
    double at_x = value(x), at_y = value(y);
    while (b - a > 0.02) {
      if (at_x < at_y) {
        b = y;
        y = x;
        at_y = at_x;
        x = b - kGolden * (b - a);
        at_x = value(x);
      } else {
        a = x;
        x = y;
        at_x = at_y;
        y = a + kGolden * (b - a);
        at_y = value(y);
      }
    }
    noise_.*sigma = std::exp(0.5 * (a + b));
  }

  void estimateNoise(bool with_time_offset) {
    const Basis active = activeBasis(options_, smoother_.parameters().soft_iron, with_time_offset);
    const double stated = stated_.gyroscope_density_rad_per_s_sqrtHz;
    constexpr int kRounds = 2;
    for (int round = 0; round < kRounds; ++round) {
      const double rms = std::max(1e-9, residualRms());
      minimize(&SmootherNoise::reading_sigma, 0.5 * rms, 3.0 * rms, active);
      minimize(&SmootherNoise::gyroscope_density, 0.5 * stated, 100.0 * stated, active);
    }
  }

  /// RMS residual of one reading and axis.
  double residualRms() const {
    double square = 0.0;
    double count = 0.0;
    for (size_t k = 0; k < smoother_.moments().size(); ++k) {
      if (!smoother_.moments()[k].used) continue;
      square += smoother_.fieldResidualAt(k).squaredNorm() * static_cast<double>(smoother_.readingsAt(k));
      count += 3.0;
    }
    return std::sqrt(square / std::max(1.0, count));
  }

  void rejectOutliers() {
    for (size_t k = 0; k < smoother_.moments().size(); ++k) {
      const double sigma = noise_.reading_sigma / std::sqrt(static_cast<double>(smoother_.readingsAt(k)));
      smoother_.setUsed(k, smoother_.fieldResidualAt(k).norm() < options_.rejection_sigmas * sigma);
    }
  }

  /// Covariance, increased for residuals that are correlated in time.
  Eigen::MatrixXd covarianceWith(bool with_time_offset, double correlation_factor = 1.0) const {
    InertialSmoother::Chain chain = smoother_.equations(noise_);
    Step left_out = Step::Zero();
    if (options_.model != IronModel::Full) left_out.segment<3>(3).setConstant(options_.left_out_skew_sigma);
    if (options_.model == IronModel::Scale || options_.model == IronModel::Offset) {
      left_out.head<3>().setConstant(options_.left_out_scale_sigma);
    }
    return consideredCovariance(chain.eliminate().information / correlation_factor,
                                activeBasis(options_, smoother_.parameters().soft_iron, with_time_offset),
                                left_out.cwiseAbs2().asDiagonal().toDenseMatrix());
  }

  void finish(InertialCalibration* result) const {
    result->parameters = smoother_.parameters();
    result->reading_sigma = noise_.reading_sigma;
    result->gyroscope_noise_factor = noise_.gyroscope_density / stated_.gyroscope_density_rad_per_s_sqrtHz;
    std::vector<double> axes[3];
    double square = 0.0;
    for (size_t k = 0; k < smoother_.moments().size(); ++k) {
      if (!smoother_.moments()[k].used) continue;
      const Vec3 r = smoother_.fieldResidualAt(k);
      square += r.squaredNorm() / 3.0;
      for (int i = 0; i < 3; ++i) axes[i].push_back(r[i]);
    }
    const double count = static_cast<double>(axes[0].size());
    result->residual = std::sqrt(square / std::max(1.0, count));
    result->rejected_share = 1.0 - count / static_cast<double>(smoother_.moments().size());
    result->correlation_factor = 0.0;
    for (const auto& axis : axes) result->correlation_factor += correlationFactor(axis) / 3.0;
    result->covariance = covarianceWith(result->time_offset_significant, result->correlation_factor);
  }

  InertialCalibrationOptions options_;
  InertialSmoother smoother_;
  ImuNoise stated_;
  SmootherNoise noise_;
};

}  // namespace

InertialCalibration calibrateWithInertialSensors(std::span<const NormalizedFieldSample> field,
                                                 std::span<const ImuSample> imu, const ImuNoise& noise,
                                                 const InertialParameters& start,
                                                 const InertialCalibrationOptions& options) {
  return Calibrator(field, imu, noise, start, options).run();
}

}  // namespace lodeline
