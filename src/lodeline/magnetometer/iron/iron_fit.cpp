#include "lodeline/magnetometer/iron/iron_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "lodeline/diagnostics.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

using Vec9 = Eigen::Matrix<double, 9, 1>;
using Mat9 = Eigen::Matrix<double, 9, 9>;
using Basis = Eigen::Matrix<double, 9, Eigen::Dynamic>;

struct NormalEquations {
  Mat9 matrix = Mat9::Zero();
  Vec9 gradient = Vec9::Zero();
  double cost = 0.0;
  int count = 0;
};

NormalEquations accumulate(std::span<const Vec3> readings, const std::vector<bool>& used,
                           const IronParameters& parameters) {
  NormalEquations normal;
  for (size_t i = 0; i < readings.size(); ++i) {
    if (!used[i]) continue;
    const IronResidual r = ironResidual(readings[i], parameters);
    normal.matrix += r.jacobian.transpose() * r.jacobian;
    normal.gradient += r.jacobian.transpose() * r.distance;
    normal.cost += r.distance * r.distance;
    ++normal.count;
  }
  return normal;
}

IronParameters moved(const IronParameters& from, const Vec9& step) {
  IronParameters to = from;
  to.correction += symmetricMatrix(step.head<6>());
  to.hard_iron += step.tail<3>();
  return to;
}

bool positiveDefinite(const Mat3& matrix) { return Eigen::LLT<Mat3>(matrix).info() == Eigen::Success; }

/// Levenberg-Marquardt over the selected readings.
IronParameters minimize(std::span<const Vec3> readings, const std::vector<bool>& used, IronParameters at,
                        const IronFitOptions& options) {
  double damping = 1e-6;
  NormalEquations normal = accumulate(readings, used, at);
  for (int i = 0; i < options.max_iterations; ++i) {
    const Basis basis = activeDirections(options.model, at.correction);
    Eigen::MatrixXd h = basis.transpose() * normal.matrix * basis;
    const Eigen::VectorXd g = basis.transpose() * normal.gradient;
    h.diagonal() *= 1.0 + damping;
    const Eigen::VectorXd reduced = h.ldlt().solve(-g);
    const IronParameters next = moved(at, basis * reduced);
    const NormalEquations there =
        positiveDefinite(next.correction) ? accumulate(readings, used, next) : NormalEquations();
    if (there.count > 0 && there.cost <= normal.cost) {
      const double gain = normal.cost - there.cost;
      at = next;
      normal = there;
      damping = std::max(1e-12, damping * 0.1);
      if (gain <= 1e-13 * normal.cost) break;
    } else {
      damping *= 10.0;
      if (damping > 1e8) break;
    }
  }
  return at;
}

std::vector<double> distances(std::span<const Vec3> readings, const IronParameters& parameters) {
  std::vector<double> result;
  result.reserve(readings.size());
  for (const Vec3& reading : readings) result.push_back(ironResidual(reading, parameters).distance);
  return result;
}

/// Selects readings within this number of robust standard deviations. An exact record must not lose readings
/// to rounding errors.
std::vector<bool> within(double sigmas, const std::vector<double>& distances) {
  const double limit = sigmas * std::max(robustSigma(distances), 1e-9);
  std::vector<bool> used(distances.size());
  for (size_t i = 0; i < distances.size(); ++i) used[i] = std::abs(distances[i]) <= limit;
  return used;
}

double conditionNumber(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
  const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues();
  if (!(eigenvalues.minCoeff() > 0.0)) return std::numeric_limits<double>::infinity();
  return eigenvalues.maxCoeff() / eigenvalues.minCoeff();
}

void assess(std::span<const Vec3> readings, const IronFitOptions& options, IronFit* fit) {
  const NormalEquations normal = accumulate(readings, fit->used, fit->parameters);
  const Basis basis = activeDirections(options.model, fit->parameters.correction);
  const double freedom = std::max(1.0, normal.count - static_cast<double>(basis.cols()));
  fit->sigma = std::sqrt(normal.cost / freedom);
  fit->condition_number = conditionNumber(basis.transpose() * normal.matrix * basis);
  std::vector<double> series;
  const std::vector<double> all = distances(readings, fit->parameters);
  for (size_t i = 0; i < all.size(); ++i) {
    if (fit->used[i]) series.push_back(all[i]);
  }
  fit->correlation_factor = correlationFactor(series);
  const double variance = std::max(1e-300, fit->sigma * fit->sigma * fit->correlation_factor);
  Vec9 left_out = Vec9::Zero();
  if (options.model != IronModel::Full) left_out.segment<3>(3).setConstant(options.left_out_skew_sigma);
  if (options.model == IronModel::Scale || options.model == IronModel::Offset) {
    left_out.head<3>().setConstant(options.left_out_scale_sigma);
  }
  fit->covariance = consideredCovariance(normal.matrix / variance, basis,
                                         left_out.cwiseAbs2().asDiagonal().toDenseMatrix());
}

}  // namespace

Eigen::Matrix<double, 9, Eigen::Dynamic> activeDirections(IronModel model, const Mat3& correction) {
  const int iron_count = model == IronModel::Full       ? 6
                         : model == IronModel::Diagonal ? 3
                         : model == IronModel::Scale    ? 1
                                                        : 0;
  Eigen::Matrix<double, 9, Eigen::Dynamic> basis =
      Eigen::Matrix<double, 9, Eigen::Dynamic>::Zero(9, iron_count + 3);
  if (model == IronModel::Scale) {
    basis.block<6, 1>(0, 0) = symmetricEntries(correction);
  } else {
    for (int i = 0; i < iron_count; ++i) basis(i, i) = 1.0;
  }
  basis.bottomRightCorner<3, 3>().setIdentity();
  return basis;
}

Eigen::MatrixXd consideredCovariance(const Eigen::MatrixXd& information, const Eigen::MatrixXd& active,
                                     const Eigen::MatrixXd& left_out) {
  const Eigen::MatrixXd reduced = active.transpose() * information * active;
  // Parameters have different units, so the matrix is scaled to a unit diagonal before inversion.
  const Eigen::VectorXd scale = reduced.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inverse =
      (scale.asDiagonal() * reduced * scale.asDiagonal()).completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::MatrixXd k = active * scale.asDiagonal() * inverse * scale.asDiagonal() * active.transpose();
  const Eigen::MatrixXd held = Eigen::MatrixXd::Identity(k.rows(), k.cols()) - k * information;
  return k + held * left_out * held.transpose();
}

IronResidual ironResidual(const Vec3& reading, const IronParameters& parameters) {
  const Vec3 d = reading - parameters.hard_iron;
  const Vec3 z = parameters.correction * d;
  const double norm = std::max(z.norm(), 1e-300);
  const Vec3 u = z / norm;
  const Vec3 gradient = parameters.correction.transpose() * u;  // gradient of |z| by the reading
  const double weight = 1.0 / std::max(gradient.norm(), 1e-300);
  IronResidual result;
  result.distance = weight * (norm - 1.0);
  result.jacobian << u.x() * d.x(), u.y() * d.y(), u.z() * d.z(), u.x() * d.y() + u.y() * d.x(),
      u.x() * d.z() + u.z() * d.x(), u.y() * d.z() + u.z() * d.y(), -gradient.x(), -gradient.y(),
      -gradient.z();
  result.jacobian *= weight;
  return result;
}

IronFit fitIron(std::span<const Vec3> readings, const IronParameters& start, const IronFitOptions& options) {
  // In units of the sphere's radius, all parameters are of order one.
  const double radius = 1.0 / std::cbrt(start.correction.determinant());
  std::vector<Vec3> scaled;
  scaled.reserve(readings.size());
  for (const Vec3& reading : readings) scaled.push_back((reading - start.hard_iron) / radius);

  IronFit fit;
  fit.parameters.correction = start.correction * radius;
  // Large outliers at the start would dominate the first round.
  constexpr double kWild_sigmas = 20.0;
  fit.used = within(kWild_sigmas, distances(scaled, fit.parameters));
  constexpr int kMostRounds = 30;
  for (int round = 0; round < kMostRounds; ++round) {
    fit.parameters = minimize(scaled, fit.used, fit.parameters, options);
    std::vector<bool> used = within(options.rejection_sigmas, distances(scaled, fit.parameters));
    const bool settled = used == fit.used;
    fit.used = std::move(used);
    if (settled) break;
  }
  assess(scaled, options, &fit);
  const Vec3& h = fit.parameters.hard_iron;
  if (!positiveDefinite(fit.parameters.correction) || !h.allFinite() || h.norm() > 1e3) {
    throw EstimationError("the fit of soft and hard iron did not converge");
  }
  fit.parameters.correction /= radius;
  fit.parameters.hard_iron = start.hard_iron + radius * h;
  fit.sigma *= radius;
  Vec9 unit;
  unit << Vec3::Constant(1.0 / radius), Vec3::Constant(1.0 / radius), Vec3::Constant(radius);
  fit.covariance = (unit.asDiagonal() * fit.covariance * unit.asDiagonal()).eval();
  return fit;
}

double correlationFactor(std::span<const double> series) {
  const size_t n = series.size();
  double mean = 0.0;
  for (const double value : series) mean += value / static_cast<double>(n);
  double variance = 0.0;
  for (const double value : series) variance += (value - mean) * (value - mean);
  if (n < 3 || !(variance > 0.0)) return 1.0;
  double factor = 1.0;
  for (size_t lag = 1; lag < n / 3; ++lag) {
    double sum = 0.0;
    for (size_t i = lag; i < n; ++i) sum += (series[i] - mean) * (series[i - lag] - mean);
    // Below twice the scatter of an estimate from independent values, it is not significant.
    if (sum / variance < 2.0 / std::sqrt(static_cast<double>(n))) break;
    factor += 2.0 * sum / variance;
  }
  return factor;
}

double robustSigma(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  return 1.4826 * median(std::move(values));
}

}  // namespace lodeline
