#include "lodeline/inspection/survey/turn_comparison.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr double kSearch_s = 1.0;
constexpr double kSearchStep_s = 4e-3;
/// Larger offsets are searched for where no small one correlates clearly, and used only where they do. Noise
/// that makes the correlation vague at the true offset lowers it at all others.
constexpr double kWideSearch_s = 8.0, kWideStep_s = 20e-3, kVague = 0.93, kClear = 0.97, kGain = 0.04;
/// A camera with a smaller rate (root mean square) does not allow a comparison.
constexpr double kLeastRate_rad_per_s = 0.02;
/// A direction with a smaller share of the rotation is not evaluated.
constexpr double kHiddenShare = 0.08;
constexpr double kSignificant_sigmas = 4.0;

struct Pair {
  Vec3 camera_B = Vec3::Zero();  ///< the camera's rate in body axes, as calibrated
  Vec3 gyroscope_B = Vec3::Zero();
};

/// Second moments of the pairs about their means.
struct Moments {
  Mat3 gyroscope = Mat3::Zero();
  Mat3 cross = Mat3::Zero();  ///< camera by gyroscope
  double camera = 0.0;
  Vec3 mean_camera = Vec3::Zero(), mean_gyroscope = Vec3::Zero();

  explicit Moments(const std::vector<Pair>& pairs) {
    for (const Pair& pair : pairs) {
      mean_camera += pair.camera_B / static_cast<double>(pairs.size());
      mean_gyroscope += pair.gyroscope_B / static_cast<double>(pairs.size());
    }
    for (const Pair& pair : pairs) {
      const Vec3 c = pair.camera_B - mean_camera;
      const Vec3 g = pair.gyroscope_B - mean_gyroscope;
      gyroscope += g * g.transpose();
      cross += c * g.transpose();
      camera += c.squaredNorm();
    }
  }

  /// Correlation under the best rotation (proper or improper) and scale.
  double correlation() const {
    const double sizes = camera * gyroscope.trace();
    if (!(sizes > 0.0)) return 0.0;
    return Eigen::JacobiSVD<Mat3>(cross).singularValues().sum() / std::sqrt(sizes);
  }
};

class Comparison {
 public:
  Comparison(const std::vector<CameraTurn>& turns, const GyroscopeIntegral& gyroscope,
             const Quat& body_from_camera, const TurnLimits& limits)
      : turns_(turns),
        gyroscope_(gyroscope),
        body_from_camera_(body_from_camera),
        limits_(limits),
        use_(turns.size(), true) {}

  std::optional<TurnComparison> run() {
    Settled settled = settle(false);
    if (settled.correlation < kVague && limits_.searches_wide) {
      Settled wide = settle(true);
      if (wide.correlation > kClear && wide.correlation > settled.correlation + kGain)
        settled = std::move(wide);
    }
    use_ = std::move(settled.use);
    const double offset_s = settled.offset_s;
    const std::vector<Pair> pairs = pairsAt(offset_s);
    if (static_cast<int>(pairs.size()) < limits_.turns) return std::nullopt;
    const Moments moments(pairs);
    TurnComparison result;
    const auto count = static_cast<double>(pairs.size());
    result.camera_rate_rad_per_s = std::sqrt(moments.camera / count);
    result.gyroscope_rate_rad_per_s = std::sqrt(moments.gyroscope.trace() / count);
    if (result.camera_rate_rad_per_s < kLeastRate_rad_per_s) return std::nullopt;
    result.turns = static_cast<int>(pairs.size());
    result.time_offset_s = offset_s;
    result.correlation = moments.correlation();
    fitAxes(moments, &result);
    judge(pairs, moments, &result);
    result.time_offset_sigma_s = offsetSigma_s(offset_s, moments, result);
    return result;
  }

 private:
  /// An offset and the rotations that fit it.
  struct Settled {
    double offset_s = 0.0, correlation = 0.0;
    std::vector<bool> use;
  };

  Settled settle(bool is_wide) {
    use_.assign(turns_.size(), true);
    double offset_s = bestOffset_s(limits_.around_s, is_wide);
    rejectOutliers(offset_s);
    offset_s = bestOffset_s(is_wide ? offset_s : limits_.around_s, false);
    return {offset_s, correlationAt(offset_s), use_};
  }

  std::vector<Pair> pairsAt(double offset_s) const {
    std::vector<Pair> pairs;
    for (size_t i = 0; i < turns_.size(); ++i) {
      if (!use_[i]) continue;
      const double begin_s = (turns_[i].begin - gyroscope_.origin()).seconds() + offset_s;
      const double end_s = (turns_[i].end - gyroscope_.origin()).seconds() + offset_s;
      const std::optional<Vec3> rate_B = gyroscope_.meanRate_B(begin_s, end_s);
      if (rate_B) pairs.push_back({body_from_camera_ * turns_[i].rate_C, *rate_B});
    }
    return pairs;
  }

  double correlationAt(double offset_s) const {
    const std::vector<Pair> pairs = pairsAt(offset_s);
    // A smaller number of rotations within the readings correlates better by chance.
    if (static_cast<int>(pairs.size()) < limits_.turns || 2 * pairs.size() < turns_.size()) return 0.0;
    return Moments(pairs).correlation();
  }

  /// Offset with the largest correlation; among nearly equal ones, as with periodic motion, the smallest
  /// offset.
  double bestOffset_s(double from_s, bool is_wide) const {
    double best_s = from_s, best = correlationAt(from_s);
    if (is_wide) {
      search(from_s, kWideSearch_s, kWideStep_s, &best_s, &best);
      search(best_s, kWideStep_s, kSearchStep_s, &best_s, &best);
    } else {
      search(from_s, kSearch_s, kSearchStep_s, &best_s, &best);
    }
    const double before = correlationAt(best_s - kSearchStep_s);
    const double after = correlationAt(best_s + kSearchStep_s);
    const double curvature = before - 2.0 * best + after;
    if (!(curvature < 0.0)) return best_s;
    const double shift = std::clamp(0.5 * (before - after) / curvature, -1.0, 1.0);
    return best_s + shift * kSearchStep_s;
  }

  /// Improves the best offset and its correlation by those within `width_s` of `from_s`, from the middle out.
  void search(double from_s, double width_s, double step_s, double* best_s, double* best) const {
    constexpr double kNearlyEqual = 0.01;
    for (int i = 1; i * step_s <= width_s; ++i) {
      for (const double offset_s : {from_s + i * step_s, from_s - i * step_s}) {
        const double correlation = correlationAt(offset_s);
        const bool is_neighbour = std::abs(offset_s - *best_s) < 1.5 * step_s;
        if (correlation <= *best + (is_neighbour ? 0.0 : kNearlyEqual)) continue;
        *best = correlation;
        *best_s = offset_s;
      }
    }
  }

  static Mat3 regression(const Moments& moments) {
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(moments.gyroscope);
    Mat3 inverse = Mat3::Zero();
    for (int i = 0; i < 3; ++i) {
      const double value = solver.eigenvalues()[i];
      if (value <= kHiddenShare * kHiddenShare * moments.gyroscope.trace()) continue;
      inverse += solver.eigenvectors().col(i) * solver.eigenvectors().col(i).transpose() / value;
    }
    return moments.cross * inverse;
  }

  /// Removes rotations that do not fit the linear relation, because their estimates are wrong.
  void rejectOutliers(double offset_s) {
    const std::vector<Pair> pairs = pairsAt(offset_s);
    const Moments moments(pairs);
    const Mat3 relation = regression(moments);
    std::vector<double> errors;
    for (const Pair& pair : pairs) errors.push_back(error(pair, relation, moments).norm());
    const double limit = 4.0 * median(errors);
    size_t next = 0;
    for (size_t i = 0; i < turns_.size(); ++i) {
      const double begin_s = (turns_[i].begin - gyroscope_.origin()).seconds() + offset_s;
      const double end_s = (turns_[i].end - gyroscope_.origin()).seconds() + offset_s;
      if (!gyroscope_.meanRate_B(begin_s, end_s)) continue;
      use_[i] = errors[next++] <= limit;
    }
  }

  static Vec3 error(const Pair& pair, const Mat3& relation, const Moments& moments) {
    return pair.camera_B - moments.mean_camera - relation * (pair.gyroscope_B - moments.mean_gyroscope);
  }

  static void fitAxes(const Moments& moments, TurnComparison* result) {
    result->body_from_gyroscope = regression(moments);
    const Eigen::JacobiSVD<Mat3> svd(moments.cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Mat3 any = svd.matrixU() * svd.matrixV().transpose();
    const Vec3& sizes = svd.singularValues();
    // If the best rotation is improper, a proper one loses twice the smallest singular value.
    const double proper = sizes.sum() - 2.0 * (any.determinant() < 0.0 ? sizes[2] : 0.0);
    constexpr double kMuchBetter = 0.95;
    result->is_mirrored = proper < kMuchBetter * sizes.sum();
    const Vec3 signs(1.0, 1.0, result->is_mirrored || any.determinant() > 0.0 ? 1.0 : -1.0);
    result->axes = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
    result->gyroscope_scale = std::sqrt(moments.camera / moments.gyroscope.trace());
  }

  void judge(const std::vector<Pair>& pairs, const Moments& moments, TurnComparison* result) const {
    double as_calibrated = 0.0, at_best = 0.0;
    for (const Pair& pair : pairs) {
      as_calibrated += error(pair, Mat3::Identity(), moments).squaredNorm();
      at_best += error(pair, result->body_from_gyroscope, moments).squaredNorm();
    }
    result->explained = 1.0 - as_calibrated / moments.camera;
    result->explained_at_best = 1.0 - at_best / moments.camera;
    const double variance = at_best / (3.0 * static_cast<double>(pairs.size()));
    judgeMisalignment(pairs, moments, variance, result);
    judgeFocalLength(pairs, moments, variance, result);
  }

  /// Covariance of `axes` (rad, body axes) by the jackknife over blocks of successive rotations. Errors of
  /// rotations by images last as long as a motion does: a translation looks like a small rotation.
  static Mat3 axesCovariance(const std::vector<Pair>& pairs, const Mat3& axes) {
    constexpr size_t kBlocks = 12;
    std::array<Vec3, kBlocks> deviations;
    Vec3 mean = Vec3::Zero();
    for (size_t block = 0; block < kBlocks; ++block) {
      std::vector<Pair> others;
      for (size_t i = 0; i < pairs.size(); ++i) {
        if (i * kBlocks / pairs.size() != block) others.push_back(pairs[i]);
      }
      TurnComparison without;
      fitAxes(Moments(others), &without);
      deviations[block] = without.is_mirrored ? Vec3::Constant(std::numbers::pi)
                                              : so3::log(Quat(Mat3(without.axes * axes.transpose())));
      mean += deviations[block] / static_cast<double>(kBlocks);
    }
    Mat3 covariance = Mat3::Zero();
    for (const Vec3& deviation : deviations)
      covariance += (kBlocks - 1.0) / kBlocks * (deviation - mean) * (deviation - mean).transpose();
    return covariance;
  }

  /// The sigma of each direction is the larger of two: that of independent errors, whose information on a
  /// small rotation is the sum of |w|^2 I - w w^T, and that of axesCovariance().
  static void judgeMisalignment(const std::vector<Pair>& pairs, const Moments& moments, double variance,
                                TurnComparison* result) {
    if (result->is_mirrored) return;
    const Vec3 rotation = so3::log(Quat(result->axes));
    const double scale = result->gyroscope_scale;
    const Mat3 information =
        (moments.gyroscope.trace() * Mat3::Identity() - moments.gyroscope) * scale * scale / variance;
    const Mat3 by_blocks = axesCovariance(pairs, result->axes);
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(information);
    constexpr double kLargestSigma_rad = 0.17;
    // Quantile of Student's t with 11 degrees of freedom over that of the normal, at 4 sigma.
    constexpr double kFewBlocks = 1.5;
    for (int i = 0; i < 3; ++i) {
      const Vec3 direction = solver.eigenvectors().col(i);
      const double independent = 1.0 / std::sqrt(std::max(1e-12, solver.eigenvalues()[i]));
      const double sigma =
          std::max(independent, kFewBlocks * std::sqrt(direction.dot(by_blocks * direction)));
      const double part = direction.dot(rotation);
      if (sigma > kLargestSigma_rad) ++result->hidden_axes;
      if (sigma > kLargestSigma_rad || std::abs(part) < kSignificant_sigmas * sigma) continue;
      result->misalignment_B += part * direction;
    }
    result->misalignment_rad = result->misalignment_B.norm();
  }

  /// The rotation about the optical axis is independent of the focal length; pan and tilt are proportional to
  /// it.
  void judgeFocalLength(const std::vector<Pair>& pairs, const Moments& moments, double variance,
                        TurnComparison* result) const {
    double products = 0.0, squares = 0.0;
    for (const Pair& pair : pairs) {
      const Vec3 expected_B = result->axes * (pair.gyroscope_B - moments.mean_gyroscope);
      const Vec3 expected_C = body_from_camera_.conjugate() * expected_B;
      const Vec3 seen_C = body_from_camera_.conjugate() * (pair.camera_B - moments.mean_camera);
      products += expected_C.head<2>().dot(seen_C.head<2>());
      squares += expected_C.head<2>().squaredNorm();
    }
    if (!(squares > 0.0)) return;
    result->focal_ratio = products / squares;
    result->focal_ratio_sigma = std::sqrt(variance / squares);
  }

  /// Sigma of the offset from the noise of the rotations and the derivative of the rates.
  double offsetSigma_s(double offset_s, const Moments& moments, const TurnComparison& result) const {
    const std::vector<Pair> before = pairsAt(offset_s - kSearchStep_s);
    const std::vector<Pair> after = pairsAt(offset_s + kSearchStep_s);
    const size_t count = std::min(before.size(), after.size());
    double squares = 0.0;
    for (size_t i = 0; i < count; ++i) {
      const Vec3 change = (after[i].gyroscope_B - before[i].gyroscope_B) / (2.0 * kSearchStep_s);
      squares += (result.body_from_gyroscope * change).squaredNorm();
    }
    const double variance = (1.0 - result.explained_at_best) * moments.camera / (3.0 * result.turns);
    return squares > 0.0 ? std::sqrt(variance / squares) : kSearch_s;
  }

  const std::vector<CameraTurn>& turns_;
  const GyroscopeIntegral& gyroscope_;
  Quat body_from_camera_;
  TurnLimits limits_;
  std::vector<bool> use_;
};

}  // namespace

std::optional<TurnComparison> compareTurns(const std::vector<CameraTurn>& turns,
                                           const GyroscopeIntegral& gyroscope, const Quat& body_from_camera,
                                           const TurnLimits& limits) {
  if (static_cast<int>(turns.size()) < limits.turns) return std::nullopt;
  constexpr double kLongestPause_s = 0.3;
  double time_s = (turns.back().end - turns.back().begin).seconds();
  for (size_t i = 1; i < turns.size(); ++i) {
    time_s += std::clamp((turns[i].begin - turns[i - 1].begin).seconds(), 0.0, kLongestPause_s);
  }
  if (time_s < limits.time_s) return std::nullopt;
  return Comparison(turns, gyroscope, body_from_camera, limits).run();
}

}  // namespace lodeline
