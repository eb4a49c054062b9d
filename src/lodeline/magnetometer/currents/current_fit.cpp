#include "lodeline/magnetometer/currents/current_fit.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "lodeline/magnetometer/currents/current_residual.h"
#include "lodeline/magnetometer/currents/current_verdict.h"
#include "lodeline/magnetometer/currents/robust_lines.h"
#include "lodeline/magnetometer/iron/iron_fit.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

constexpr double kPriorSigma_uT_per_A = 10.0;  // of fields before the test
constexpr double kLeastTurn_rad = 0.1 * kDegree;
constexpr double kGreatestTurn_rad = 5.0 * kDegree;
constexpr double kGreatestLag_s = 1.0;
constexpr double kLagStep_s = 0.05;
constexpr double kLeastCurrent_A = 1.0;         // for which a channel's sigma has to be small enough
constexpr double kGreatestFieldSigma_uT = 0.2;  // at the largest current
constexpr double kModelShare = 0.02;            // of the fields: not linear, different from day to day

/// Least squares of a test with chosen channels.
class TestFit {
 public:
  TestFit(const StillTest& test, const TestTable& table) : test_(test), table_(table) {
    const bool moved =
        table.rotation_B.cols() > 0 && table.rotation_B.rowwise().norm().maxCoeff() > kLeastTurn_rad;
    slow_ = Eigen::MatrixXd(table.readings_uT.rows(), table.baseline.cols() + (moved ? 3 : 0));
    slow_.leftCols(table.baseline.cols()) = table.baseline;
    if (moved) slow_.rightCols<3>() = table.rotation_B;
    for (size_t i = 0; i < test.channels.size(); ++i) used_.push_back(static_cast<Eigen::Index>(i));
  }

  void use(std::vector<Eigen::Index> channels) { used_ = std::move(channels); }
  const std::vector<Eigen::Index>& used() const { return used_; }

  RobustLines at(double lag_s, double sigma = 0.0) const {
    const Eigen::MatrixXd design = designAt(lag_s);
    Eigen::VectorXd priors =
        Eigen::VectorXd::Constant(design.cols(), std::numeric_limits<double>::infinity());
    priors.tail(static_cast<Eigen::Index>(used_.size())).setConstant(kPriorSigma_uT_per_A);
    return fitLines(design, table_.readings_uT, priors, sigma);
  }
  /// Information on the channels beside the slow part.
  Eigen::MatrixXd besideSlowPart(const Eigen::MatrixXd& information) const {
    const Eigen::Index slow = slow_.cols(), count = information.cols() - slow;
    const Eigen::MatrixXd across = information.topRightCorner(slow, count);
    return information.bottomRightCorner(count, count) -
           across.transpose() * information.topLeftCorner(slow, slow).ldlt().solve(across);
  }
  Eigen::Index slowColumns() const { return slow_.cols(); }

 private:
  Eigen::MatrixXd designAt(double lag_s) const {
    const Eigen::MatrixXd currents = table_.currentsAt(test_, lag_s);
    Eigen::MatrixXd design(slow_.rows(), slow_.cols() + static_cast<Eigen::Index>(used_.size()));
    design.leftCols(slow_.cols()) = slow_;
    for (size_t i = 0; i < used_.size(); ++i)
      design.col(slow_.cols() + static_cast<Eigen::Index>(i)) = currents.col(used_[i]);
    return design;
  }

  const StillTest& test_;
  const TestTable& table_;
  Eigen::MatrixXd slow_;
  std::vector<Eigen::Index> used_;
};

double correlationOf(const RobustLines& lines) {
  double factor = 0.0;
  for (Eigen::Index axis = 0; axis < lines.residuals.cols(); ++axis) {
    std::vector<double> series;
    for (Eigen::Index row = 0; row < lines.residuals.rows(); ++row) {
      if (lines.weights[row] > 0.0) series.push_back(lines.residuals(row, axis));
    }
    factor += correlationFactor(series) / static_cast<double>(lines.residuals.cols());
  }
  return std::max(1.0, factor);
}

/// Variance of a residual as it counts for parameters, uT^2.
double effectiveVariance(const RobustLines& lines) {
  return lines.sigma * lines.sigma * correlationOf(lines);
}

/// The lag of the least robust cost, and its sigma. The residuals' sigma is that at the best lag by steps, so
/// that costs compare.
void findLag(const TestFit& problem, CurrentFit* fit) {
  double sigma = problem.at(0.0).sigma, best_s = 0.0;
  for (int pass = 0; pass < 2; ++pass) {
    double least = std::numeric_limits<double>::infinity();
    for (double lag_s = -kGreatestLag_s; lag_s <= kGreatestLag_s + 1e-9; lag_s += kLagStep_s) {
      const double cost = problem.at(lag_s, sigma).cost;
      if (cost < least) std::tie(least, best_s) = std::tie(cost, lag_s);
    }
    sigma = problem.at(best_s).sigma;
  }
  // Vertex of the parabola through three costs, with halved steps.
  double step_s = kLagStep_s, curvature = 0.0;
  for (int halving = 0; halving < 3; ++halving, step_s *= 0.5) {
    const double before = problem.at(best_s - step_s, sigma).cost, now = problem.at(best_s, sigma).cost,
                 after = problem.at(best_s + step_s, sigma).cost;
    curvature = (before - 2.0 * now + after) / (step_s * step_s);
    if (!(curvature > 0.0)) break;
    best_s += std::clamp(0.5 * (before - after) / (before - 2.0 * now + after), -1.0, 1.0) * step_s;
  }
  // The cost is log(1 + r^2 / (3 c^2 sigma^2)) of three axes; a chi-square is 3 c^2 times as large.
  const double chi_square_curvature = 3.0 * 2.385 * 2.385 * curvature / correlationOf(problem.at(best_s));
  fit->measured_lag_s = best_s;
  fit->lag_sigma_s = chi_square_curvature > 0.0 ? std::sqrt(2.0 / chi_square_curvature) : kGreatestLag_s;
  constexpr double kSignificant = 3.0;
  fit->lag_s = std::abs(best_s) > kSignificant * fit->lag_sigma_s ? best_s : 0.0;
}

/// Whether a channel shows nothing but the noise of its sensor: values differ from their mean as much as from
/// the value before.
bool isNoise(const StillTest& test, size_t channel) {
  constexpr double kDistinct = 2.0;
  double mean = 0.0, square = 0.0, change_square = 0.0;
  int count = 0;
  std::optional<double> before;
  for (const CurrentSample& sample : test.currents) {
    if (channel >= sample.currents_A.size() || !std::isfinite(sample.currents_A[channel])) continue;
    const double now = sample.currents_A[channel];
    if (before) change_square += 0.5 * (now - *before) * (now - *before);
    before = now;
    ++count;
    const double difference = now - mean;
    mean += difference / count;
    square += difference * (now - mean);
  }
  return square <= kDistinct * kDistinct * change_square;
}

/// Leaves out channels that change too little, and says so.
void leaveOutUnexcited(const StillTest& test, TestFit* problem, CurrentFit* fit) {
  const RobustLines lines = problem->at(0.0);
  const Eigen::MatrixXd information = problem->besideSlowPart(lines.information);
  const double variance = effectiveVariance(lines);
  std::vector<Eigen::Index> excited;
  for (size_t i = 0; i < fit->channels.size(); ++i) {
    CurrentChannel& channel = fit->channels[i];
    const auto at = static_cast<Eigen::Index>(i);
    const double prior = variance / std::pow(kPriorSigma_uT_per_A, 2);
    const double sigma = std::sqrt(variance / (std::max(0.0, information(at, at)) + prior));
    const bool is_small_sigma =
        sigma * std::max(channel.largest_A, kLeastCurrent_A) <= kGreatestFieldSigma_uT;
    if (is_small_sigma && !isNoise(test, i)) {
      excited.push_back(at);
      continue;
    }
    channel.sigma_T_per_A = 1e-6 * (is_small_sigma ? kPriorSigma_uT_per_A : sigma);
    channel.objection = fmt::format(
        "its current hardly changes (up to {:.2f} A): known to {:.2f} uT/A only; ramp it from 0 to its "
        "largest",
        channel.largest_A, 1e6 * channel.sigma_T_per_A);
  }
  if (excited.empty()) {
    throw EstimationError(
        "no channel's current changes enough to tell its field; ramp each channel from 0 to its largest "
        "current and back, one after the other, with the vehicle held still");
  }
  problem->use(std::move(excited));
}

/// Sigma, uT, of the sum of all fields where the channel has its largest current in the test.
double sigmaAtLargest_uT(const CurrentFit& fit, Eigen::Index channel) {
  Eigen::Index row = 0;
  fit.currents_A.col(channel).cwiseAbs().maxCoeff(&row);
  const Eigen::VectorXd currents_A = fit.currents_A.row(row).transpose();
  return 1e6 * std::sqrt(std::max(0.0, currents_A.dot(fit.covariance * currents_A)));
}

/// Says which channels run together so much that only the sum of their fields is known. A channel that is the
/// sum of others, such as a battery, is no fault: the sum of all fields is known where each of them runs
/// alone.
void judgeCollinear(const TestFit& problem, const Eigen::MatrixXd& information, CurrentFit* fit) {
  constexpr double kTogether = 0.9;
  const std::vector<Eigen::Index>& used = problem.used();
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * information * scale.asDiagonal();
  for (size_t i = 0; i < used.size(); ++i) {
    CurrentChannel& channel = fit->channels[static_cast<size_t>(used[i])];
    const double sigma_uT = 1e6 * channel.sigma_T_per_A * std::max(channel.largest_A, kLeastCurrent_A);
    if (sigma_uT <= kGreatestFieldSigma_uT) continue;
    Eigen::VectorXd others = correlation.row(static_cast<Eigen::Index>(i)).cwiseAbs();
    others[static_cast<Eigen::Index>(i)] = -1.0;
    Eigen::Index partner = 0;
    const double most = others.maxCoeff(&partner);
    if (most < kTogether && sigmaAtLargest_uT(*fit, used[i]) <= kGreatestFieldSigma_uT) continue;
    channel.objection = fmt::format(
        "it runs together with {} (correlation {:.3f}): known to {:.2f} uT/A only, their sum better; ramp "
        "each alone",
        fit->channels[static_cast<size_t>(used[static_cast<size_t>(partner)])].name, most,
        1e6 * channel.sigma_T_per_A);
  }
}

/// Sigma of a component of each k_i that gives the variance of the sum at the test's currents.
double fieldSigma(const StillTest& test, const CurrentFit& fit) {
  double variance = 0.0, square_A2 = 0.0, field_square = 0.0;
  for (const CurrentSample& sample : test.currents) {
    if (sample.currents_A.size() != test.channels.size()) continue;
    const Eigen::Map<const Eigen::VectorXd> currents(sample.currents_A.data(),
                                                     static_cast<Eigen::Index>(sample.currents_A.size()));
    if (!currents.allFinite()) continue;
    variance += currents.dot(fit.covariance * currents);
    square_A2 += currents.squaredNorm();
  }
  int identified = 0;
  for (const CurrentChannel& channel : fit.channels) {
    if (!channel.isIdentified()) continue;
    field_square += channel.field_T_per_A.squaredNorm() / 3.0;
    ++identified;
  }
  const double usual = std::sqrt(field_square / std::max(1, identified));
  return std::hypot(std::sqrt(square_A2 > 0.0 ? variance / square_A2 : 0.0), kModelShare * usual);
}

void takeFields(const TestFit& problem, const RobustLines& lines, CurrentFit* fit) {
  const std::vector<Eigen::Index>& used = problem.used();
  const auto count = static_cast<Eigen::Index>(used.size());
  const double variance_T2 = 1e-12 * effectiveVariance(lines);
  const Eigen::MatrixXd covariance = variance_T2 * lines.inverse.bottomRightCorner(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    CurrentChannel& channel = fit->channels[static_cast<size_t>(used[static_cast<size_t>(i)])];
    channel.field_T_per_A = 1e-6 * lines.coefficients.row(problem.slowColumns() + i).transpose();
    channel.sigma_T_per_A = std::sqrt(covariance(i, i));
    for (Eigen::Index j = 0; j < count; ++j)
      fit->covariance(used[static_cast<size_t>(i)], used[static_cast<size_t>(j)]) = covariance(i, j);
  }
  judgeCollinear(problem, problem.besideSlowPart(lines.information), fit);
}

void judgeMotion(const TestTable& table, CurrentFit* fit, Diagnostics* diagnostics) {
  fit->is_motion_known = table.rotation_B.cols() > 0;
  if (!fit->is_motion_known) {
    diagnostics->report(Severity::Notice, "current_test_motion_unknown",
                        "still test: no gyroscope tells whether the vehicle moved");
    return;
  }
  fit->turned_rad = table.rotation_B.rowwise().norm().maxCoeff();
  if (fit->turned_rad > kGreatestTurn_rad) {
    throw EstimationError(fmt::format(
        "the vehicle turned by {:.1f} degrees during the test, by the gyroscope; hold it or tie it down and "
        "repeat, or choose a quiet part by --from and --to",
        fit->turned_rad / kDegree));
  }
  if (fit->turned_rad > kLeastTurn_rad) {
    diagnostics->report(
        Severity::Notice, "current_test_moved",
        fmt::format("still test: the vehicle turned by up to {:.2f} degrees; the fit takes it out with the "
                    "gyroscope",
                    fit->turned_rad / kDegree));
  }
}

std::vector<CurrentChannel> channelsOf(const StillTest& test) {
  std::vector<CurrentChannel> channels;
  for (size_t i = 0; i < test.channels.size(); ++i) {
    CurrentChannel& channel = channels.emplace_back();
    channel.name = test.channels[i];
    for (const CurrentSample& sample : test.currents) {
      if (i < sample.currents_A.size() && std::isfinite(sample.currents_A[i]))
        channel.largest_A = std::max(channel.largest_A, std::abs(sample.currents_A[i]));
    }
  }
  return channels;
}

void requireCurrents(const StillTest& test, const TestTable& table) {
  const Eigen::MatrixXd currents = table.currentsAt(test, 0.0);
  Eigen::Index known = 0;
  for (Eigen::Index row = 0; row < currents.rows(); ++row) known += currents.row(row).allFinite() ? 1 : 0;
  if (test.channels.empty() || 2 * known < currents.rows()) {
    throw EstimationError(
        fmt::format("currents are known for {:.0f} % of the magnetometer's readings only; both must be "
                    "recorded at the same "
                    "time, with currents more often than each second",
                    100.0 * static_cast<double>(known) / static_cast<double>(currents.rows())));
  }
}

}  // namespace

bool CurrentFit::isComplete() const {
  return std::all_of(channels.begin(), channels.end(),
                     [](const CurrentChannel& channel) { return channel.isIdentified(); });
}

Eigen::MatrixXd CurrentFit::fields_T_per_A() const {
  Eigen::MatrixXd fields(static_cast<Eigen::Index>(channels.size()), 3);
  for (size_t i = 0; i < channels.size(); ++i)
    fields.row(static_cast<Eigen::Index>(i)) = channels[i].field_T_per_A.transpose();
  return fields;
}

CurrentFit fitCurrents(const StillTest& test, Diagnostics* diagnostics) {
  CurrentFit fit;
  fit.table = tabulate(test, diagnostics);
  const TestTable& table = fit.table;
  requireCurrents(test, table);
  fit.channels = channelsOf(test);
  const auto count = static_cast<Eigen::Index>(fit.channels.size());
  fit.covariance.setZero(count, count);
  fit.rate_hz = rateOf(test.currents);
  judgeMotion(table, &fit, diagnostics);
  TestFit problem(test, table);
  leaveOutUnexcited(test, &problem, &fit);
  findLag(problem, &fit);
  fit.lines = problem.at(fit.lag_s);
  const Eigen::MatrixXd currents_A = table.currentsAt(test, fit.lag_s);
  fit.currents_A = currents_A.array().isFinite().select(currents_A, 0.0);
  takeFields(problem, fit.lines, &fit);
  fit.field_sigma_T_per_A = fieldSigma(test, fit);
  fit.without = residualOf(fit, fit.fields_T_per_A());
  fit.with = residualOf(fit, Eigen::MatrixXd::Zero(count, 3));
  fit.correlated_rms_rad = slowHeading_rad(fit);
  fit.heading_source = table.is_level_known ? "accelerometer" : "assumed";
  const auto weights = fit.lines.weights.array();
  fit.readings = static_cast<int>((weights > 0.0).count());
  fit.rejected_share =
      static_cast<double>((weights > 0.0 && weights < 0.1).count()) / std::max(1, fit.readings);
  fit.verdict = verdictOf(fit);
  return fit;
}

}  // namespace lodeline
