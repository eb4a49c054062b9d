#include "lodeline/magnetometer/calibration/hard_iron_change.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "lodeline/magnetometer/iron/iron_fit.h"

namespace lodeline {
namespace {

constexpr double kStretch_s = 20.0;
constexpr int kStretches = 4;
constexpr double kLeastStep_T = 0.15e-6;
constexpr double kLeastStep_sigmas = 4.0;
/// Minimum of the smallest eigenvalue of the mean of u u^T; 1/3 for evenly distributed directions.
constexpr double kLeastSpread = 0.05;
constexpr size_t kFewestReadings = 30;

/// Sums over a stretch of readings.
struct Stretch {
  Mat3 normal = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  size_t count = 0;

  bool tells() const {
    if (count < kFewestReadings) return false;
    const Mat3 mean = normal / static_cast<double>(count);
    return Eigen::SelfAdjointEigenSolver<Mat3>(mean).eigenvalues()[0] > kLeastSpread;
  }
  Vec3 offset() const { return normal.ldlt().solve(right); }
  Mat3 covariance(double variance_T2) const { return variance_T2 * normal.inverse(); }
};

class Offsets {
 public:
  Offsets(std::span<const CorrectedReading> readings, double field_strength_T) : readings_(readings) {
    std::vector<double> series;
    sums_.emplace_back();
    for (const CorrectedReading& reading : readings) {
      const Vec3 u = reading.field_M.normalized();
      const double residual_T = reading.field_M.norm() - field_strength_T;
      Stretch sum = sums_.back();
      sum.normal += u * u.transpose();
      sum.right += u * residual_T;
      ++sum.count;
      sums_.push_back(sum);
      series.push_back(residual_T);
    }
    // Differences of neighbouring readings give the noise without changes of the iron.
    double squares = 0.0;
    for (size_t i = 1; i < series.size(); ++i) squares += std::pow(series[i] - series[i - 1], 2);
    const double white_T2 = squares / (2.0 * std::max<double>(1.0, static_cast<double>(series.size()) - 1.0));
    variance_T2_ = white_T2 * correlationFactor(withoutOffsets(series));
  }

  Stretch between(size_t begin, size_t end) const {
    Stretch stretch = sums_[end];
    stretch.normal -= sums_[begin].normal;
    stretch.right -= sums_[begin].right;
    stretch.count -= sums_[begin].count;
    return stretch;
  }
  double variance_T2() const { return variance_T2_; }

 private:
  /// Residuals after an own offset was estimated for each stretch.
  std::vector<double> withoutOffsets(std::vector<double> series) const {
    for (int k = 0; k < 2 * kStretches; ++k) {
      const size_t begin = series.size() * static_cast<size_t>(k) / (2 * kStretches);
      const size_t end = series.size() * static_cast<size_t>(k + 1) / (2 * kStretches);
      const Stretch stretch = between(begin, end);
      if (!stretch.tells()) continue;
      const Vec3 offset = stretch.offset();
      for (size_t i = begin; i < end; ++i) series[i] -= readings_[i].field_M.normalized().dot(offset);
    }
    return series;
  }

  std::span<const CorrectedReading> readings_;
  std::vector<Stretch> sums_;  ///< sums over the readings before
  double variance_T2_ = 0.0;
};

std::optional<HardIronChange::Step> greatestStep(std::span<const CorrectedReading> readings,
                                                 const Offsets& offsets) {
  std::optional<HardIronChange::Step> greatest;
  double greatest_chi2 = kLeastStep_sigmas * kLeastStep_sigmas;
  const double length_s = (readings.back().time - readings.front().time).seconds();
  const double stretch_s = std::min(kStretch_s, 0.25 * length_s);
  const auto firstAfter = [&](Time time) {
    const auto at = std::lower_bound(readings.begin(), readings.end(), time,
                                     [](const CorrectedReading& r, Time t) { return r.time < t; });
    return static_cast<size_t>(at - readings.begin());
  };
  for (double at_s = stretch_s; at_s + stretch_s <= length_s; at_s += 0.05 * stretch_s) {
    const Time middle = readings.front().time + Duration::fromSeconds(at_s);
    const Duration stretch = Duration::fromSeconds(stretch_s);
    const size_t split = firstAfter(middle);
    const Stretch before = offsets.between(firstAfter(middle - stretch), split);
    const Stretch after = offsets.between(split, firstAfter(middle + stretch));
    if (!before.tells() || !after.tells()) continue;
    const Vec3 step_T = after.offset() - before.offset();
    const Mat3 covariance =
        before.covariance(offsets.variance_T2()) + after.covariance(offsets.variance_T2());
    const double chi2 = step_T.dot(covariance.ldlt().solve(step_T));
    if (step_T.norm() < kLeastStep_T || chi2 < greatest_chi2) continue;
    greatest_chi2 = chi2;
    greatest = HardIronChange::Step{middle, step_T.norm(), std::sqrt(covariance.diagonal().maxCoeff())};
  }
  return greatest;
}

/// Returns zero unless the stretches' offsets differ by three sigma (chi-square) of their noise.
double spreadOf(const Offsets& offsets, size_t count) {
  std::vector<Vec3> found;
  std::vector<Mat3> noise;
  Vec3 mean = Vec3::Zero();
  for (size_t k = 0; k < kStretches; ++k) {
    const Stretch stretch = offsets.between(count * k / kStretches, count * (k + 1) / kStretches);
    if (!stretch.tells()) continue;
    found.push_back(stretch.offset());
    noise.push_back(stretch.covariance(offsets.variance_T2()));
    mean += found.back();
  }
  if (found.size() < 2) return 0.0;
  const auto stretches = static_cast<double>(found.size());
  mean /= stretches;
  double chi2 = 0.0, square = 0.0;
  for (size_t k = 0; k < found.size(); ++k) {
    const Vec3 difference = found[k] - mean;
    chi2 += difference.dot(noise[k].ldlt().solve(difference));
    square += difference.squaredNorm() / 3.0 / (stretches - 1.0) - noise[k].trace() / 3.0 / stretches;
  }
  const double freedom = 3.0 * (stretches - 1.0);
  return chi2 > freedom + 3.0 * std::sqrt(2.0 * freedom) ? std::sqrt(std::max(0.0, square)) : 0.0;
}

}  // namespace

HardIronChange findHardIronChange(std::span<const CorrectedReading> readings, double field_strength_T) {
  HardIronChange change;
  if (readings.size() < kStretches * kFewestReadings) return change;
  const Offsets offsets(readings, field_strength_T);
  change.step = greatestStep(readings, offsets);
  change.spread_T = spreadOf(offsets, readings.size());
  return change;
}

}  // namespace lodeline
