#include "lodeline/imu/noise/noise_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace lodeline {
namespace {

using Coefficients = Eigen::Matrix<double, kNoiseKinds, 1>;
using Information = Eigen::Matrix<double, kNoiseKinds, kNoiseKinds>;

constexpr size_t kFewestPoints = 6;
constexpr int kIterations = 8;
constexpr unsigned kRampBit = 1U << static_cast<unsigned>(NoiseKind::Ramp);
constexpr unsigned kAllKinds = (1U << kNoiseKinds) - 1U;

bool isPowerOfTwo(int64_t n) { return (n & (n - 1)) == 0; }

double slope(const AllanPoint& from, const AllanPoint& to, double from_variance, double to_variance) {
  return 0.5 * std::log(to_variance / from_variance) / std::log(to.tau_s / from.tau_s);
}

/// The averaging times of the fit and their variances: one per octave, because intermediate ones add almost
/// no information.
struct Sampled {
  std::vector<AllanPoint> points;
  Eigen::VectorXd variance;
};

Sampled sample(const AllanCurve& curve, std::optional<int> axis, double longest_s) {
  Sampled sampled;
  std::vector<double> values;
  for (const AllanPoint& point : curve.points) {
    if (!isPowerOfTwo(point.factor) || point.tau_s > longest_s) continue;
    const double value = axis ? point.variance[*axis] : point.variance.mean();
    if (!(value > 0.0)) continue;
    sampled.points.push_back(point);
    values.push_back(value);
  }
  sampled.variance =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  return sampled;
}

/// Index of the point from which the deviation decreases like that of white noise; nothing where it never
/// does.
std::optional<size_t> whiteBegin(const Sampled& s, double tolerance, bool* is_filtered) {
  std::optional<size_t> steepest;
  double least = -0.5 + tolerance;
  for (size_t i = 0; i + 1 < s.points.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double here = slope(s.points[i], s.points[i + 1], s.variance[k], s.variance[k + 1]);
    // At the first point, a steeper slope is quantization, which the model includes.
    if (i == 0 && here < least) return i;
    // Beyond a filter's corner, white noise appears only gradually.
    if (here >= least) continue;
    least = here;
    steepest = i;
    *is_filtered = true;
    if (here < -0.5 + 0.25 * tolerance) break;
  }
  return steepest;
}

struct Solution {
  Coefficients squared = Coefficients::Zero();  ///< c^2 divided by the scale of the fit
  double chi_square = std::numeric_limits<double>::infinity();
};

Solution solveSubset(const Information& information, const Coefficients& right, double total,
                     unsigned subset) {
  // The equation of a coefficient outside the set is "equals zero".
  Information reduced = Information::Identity();
  Coefficients reduced_right = Coefficients::Zero();
  const auto isIn = [subset](int kind) { return (subset >> static_cast<unsigned>(kind) & 1U) != 0; };
  for (int row = 0; row < kNoiseKinds; ++row) {
    if (!isIn(row)) continue;
    reduced_right[row] = right[row];
    for (int column = 0; column < kNoiseKinds; ++column) {
      if (isIn(column)) reduced(row, column) = information(row, column);
    }
  }
  Solution solution;
  const Coefficients values = reduced.ldlt().solve(reduced_right);
  if (!values.allFinite() || values.minCoeff() < 0.0) return solution;
  solution.squared = values;
  solution.chi_square = total - reduced_right.dot(values);
  return solution;
}

/// Non-negative least squares by testing all sets of non-zero coefficients; their number is small.
Solution solveNonNegative(const Information& information, const Coefficients& right, double total,
                          bool with_ramp) {
  Solution best;
  for (unsigned subset = 1; subset <= kAllKinds; ++subset) {
    if (!with_ramp && (subset & kRampBit) != 0) continue;
    const Solution solution = solveSubset(information, right, total, subset);
    if (solution.chi_square < best.chi_square) best = solution;
  }
  return best;
}

NoiseFigure figure(double squared, double squared_sigma) {
  NoiseFigure result;
  result.value = std::sqrt(squared);
  result.at_most = std::sqrt(squared + 1.645 * squared_sigma);
  result.resolved = squared > 2.0 * squared_sigma;
  // First-order propagation through the square root, which is not valid near zero.
  result.sigma = result.resolved ? 0.5 * squared_sigma / result.value : result.at_most - result.value;
  return result;
}

/// Optional parts of the model besides the noise processes.
struct Shape {
  bool with_ramp = false;
  double corner_s = 0.0;
};

/// One fit by iteratively reweighted least squares.
class Fit {
 public:
  Fit(const Sampled& sampled, const AllanCovariance& covariance, int axes, double model_error, Shape shape)
      : shape_(shape), design_(sampled.variance.size(), kNoiseKinds) {
    const Eigen::VectorXd& variance = sampled.variance;
    for (Eigen::Index i = 0; i < variance.size(); ++i) {
      const double tau_s = sampled.points[static_cast<size_t>(i)].tau_s;
      const auto unit = unitAllanVariance(tau_s);
      design_.row(i) = Eigen::Map<const Coefficients>(unit.data());
      design_(i, static_cast<int>(NoiseKind::Flicker)) *= flickerShare(tau_s, shape.corner_s);
    }
    // Scales every coefficient to order one.
    for (int kind = 0; kind < kNoiseKinds; ++kind) {
      scale_[kind] = (variance.array() / design_.col(kind).array()).minCoeff();
      design_.col(kind) *= scale_[kind];
    }
    Eigen::MatrixXd noise = Eigen::MatrixXd(variance.cwiseAbs2().asDiagonal());
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      solve(variance, noise);
      noise = covariance(randomPart()) / axes;
      noise.diagonal() += (model_error * design_ * solution_.squared).cwiseAbs2();
    }
  }

  const Shape& shape() const { return shape_; }
  double chiSquare() const { return solution_.chi_square; }
  int unknowns() const { return static_cast<int>((solution_.squared.array() > 0.0).count()); }
  /// Minus twice the logarithm of the likelihood, up to a constant.
  double cost() const { return solution_.chi_square + log_determinant_; }

  double squared(NoiseKind kind) const {
    return solution_.squared[static_cast<int>(kind)] * scale_[static_cast<int>(kind)];
  }

  /// One sigma of each squared coefficient, with all coefficients unknown except an absent ramp.
  Coefficients sigmas() const {
    const int count = squared(NoiseKind::Ramp) > 0.0 ? kNoiseKinds : kRandomKinds;
    const Eigen::MatrixXd inverse =
        information_.topLeftCorner(count, count).ldlt().solve(Eigen::MatrixXd::Identity(count, count));
    Coefficients result = Coefficients::Zero();
    result.head(count) = inverse.diagonal().cwiseMax(0.0).cwiseSqrt();
    return result.cwiseProduct(scale_);
  }

 private:
  void solve(const Eigen::VectorXd& variance, const Eigen::MatrixXd& noise) {
    const Eigen::LLT<Eigen::MatrixXd> factor(noise);
    const Eigen::MatrixXd whitened = factor.matrixL().solve(Eigen::MatrixXd(design_));
    const Eigen::VectorXd values = factor.matrixL().solve(variance);
    information_ = whitened.transpose() * whitened;
    solution_ =
        solveNonNegative(information_, whitened.transpose() * values, values.squaredNorm(), shape_.with_ramp);
    log_determinant_ = 2.0 * Eigen::MatrixXd(factor.matrixL()).diagonal().array().log().sum();
  }

  std::array<double, kRandomKinds> randomPart() const {
    std::array<double, kRandomKinds> values{};
    for (size_t kind = 0; kind < values.size(); ++kind) values[kind] = squared(static_cast<NoiseKind>(kind));
    return values;
  }

  Shape shape_;
  Eigen::Matrix<double, Eigen::Dynamic, kNoiseKinds> design_;
  Coefficients scale_;
  Solution solution_;
  Information information_ = Information::Zero();
  double log_determinant_ = 0.0;
};

/// The simplest fit that no other one exceeds by the required gain.
Fit bestFit(const Sampled& sampled, const AllanCovariance& covariance, int axes,
            const NoiseFitOptions& options) {
  const auto fitOf = [&](const Shape& shape) {
    return Fit(sampled, covariance, axes, options.model_error, shape);
  };
  Fit best = fitOf({});
  constexpr double kCornerStep = 1.7782794;  // four per decade
  Fit cornered = best;
  for (double corner_s = 2.0 * sampled.points.front().tau_s; corner_s < options.longest_corner_s;
       corner_s *= kCornerStep) {
    Fit candidate = fitOf({false, corner_s});
    if (candidate.cost() < cornered.cost()) cornered = std::move(candidate);
  }
  if (cornered.cost() + options.believed_gain < best.cost()) best = std::move(cornered);
  Fit ramped = fitOf({true, best.shape().corner_s});
  if (ramped.cost() + options.believed_gain < best.cost()) best = std::move(ramped);
  return best;
}

}  // namespace

double NoiseFit::variance(double tau_s) const {
  auto unit = unitAllanVariance(tau_s);
  unit[static_cast<size_t>(NoiseKind::Flicker)] *= flickerShare(tau_s, flicker_corner_s);
  double sum = 0.0;
  const std::array<const NoiseFigure*, kNoiseKinds> all = {&quantization, &white, &instability, &walk, &ramp};
  for (size_t kind = 0; kind < all.size(); ++kind) sum += all[kind]->value * all[kind]->value * unit[kind];
  return sum;
}

double NoiseFit::walkWithInstability(double tau_s) const {
  const auto unit = unitAllanVariance(tau_s);
  const double flicker =
      instability.value * instability.value * unit[static_cast<size_t>(NoiseKind::Flicker)];
  return std::sqrt(walk.value * walk.value + flicker / unit[static_cast<size_t>(NoiseKind::Walk)]);
}

std::optional<NoiseFit> fitNoise(const AllanCurve& curve, std::optional<int> axis,
                                 const NoiseFitOptions& options) {
  Sampled sampled = sample(curve, axis, options.longest_share * curve.duration_s);
  if (sampled.points.size() < kFewestPoints) return std::nullopt;
  NoiseFit fit;
  const auto begin = whiteBegin(sampled, options.white_slope_tolerance, &fit.is_filtered);
  fit.lacks_white_region = !begin;
  if (begin && sampled.points.size() - *begin >= kFewestPoints) {
    sampled.points.erase(sampled.points.begin(),
                         sampled.points.begin() + static_cast<std::ptrdiff_t>(*begin));
    sampled.variance =
        Eigen::VectorXd(sampled.variance.tail(static_cast<Eigen::Index>(sampled.points.size())));
  }
  const AllanCovariance covariance(sampled.points, curve.interval_s, curve.duration_s);
  const Fit best = bestFit(sampled, covariance, axis ? 1 : 3, options);
  fit.flicker_corner_s = best.squared(NoiseKind::Flicker) > 0.0 ? best.shape().corner_s : 0.0;
  fit.misfit = best.chiSquare() / std::max(1, static_cast<int>(sampled.points.size()) - best.unknowns());
  const Coefficients sigmas = best.sigmas() * std::sqrt(std::max(1.0, fit.misfit));
  const auto figureOf = [&](NoiseKind kind) {
    return figure(best.squared(kind), sigmas[static_cast<int>(kind)]);
  };
  fit.quantization = figureOf(NoiseKind::Quantization);
  fit.white = figureOf(NoiseKind::White);
  fit.instability = figureOf(NoiseKind::Flicker);
  fit.walk = figureOf(NoiseKind::Walk);
  fit.ramp = figureOf(NoiseKind::Ramp);
  fit.shortest_s = sampled.points.front().tau_s;
  fit.longest_s = sampled.points.back().tau_s;
  return fit;
}

}  // namespace lodeline
