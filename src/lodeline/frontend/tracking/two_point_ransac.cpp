#include "lodeline/frontend/tracking/two_point_ransac.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

/// Sine of the angle between ray and translation below which an epipolar plane is not reliable.
constexpr double kNearEpipole = 0.05;

struct Motion {
  Mat3 rotation = Mat3::Identity();  ///< current from previous
  Vec3 direction = Vec3::UnitZ();    ///< of the translation, in the current frame
};

class Consensus {
 public:
  Consensus(const std::vector<Vec3>& previous, const std::vector<Vec3>& current, double focal_px)
      : previous_(previous), current_(current), focal_px_(focal_px) {}

  double errorPx(const Motion& motion, size_t i) const {
    const Vec3 normal = motion.direction.cross(motion.rotation * previous_[i]);
    return focal_px_ * std::abs(normal.dot(current_[i])) / std::max(normal.norm(), kNearEpipole);
  }

  /// Sum of errors, each limited to `limit_px`: unlike a count of inliers it also ranks the hypotheses of a
  /// slow camera.
  double truncatedCost(const Motion& motion, double limit_px) const {
    double cost = 0.0;
    for (size_t i = 0; i < current_.size(); ++i) cost += std::min(errorPx(motion, i), limit_px);
    return cost;
  }

  Motion bestHypothesis(const Mat3& rotation, double limit_px, const TwoPointRansacOptions& options) const {
    std::mt19937 random(static_cast<std::mt19937::result_type>(options.seed));
    Motion best{rotation, Vec3::UnitZ()};
    double best_cost = truncatedCost(best, limit_px);
    for (int h = 0; h < options.hypotheses; ++h) {
      const size_t i = random() % current_.size(), j = random() % current_.size();
      const Vec3 first = (rotation * previous_[i]).cross(current_[i]);
      const Vec3 second = (rotation * previous_[j]).cross(current_[j]);
      const Vec3 direction = first.cross(second);
      const double length = direction.norm();
      if (length < 1e-12) continue;
      const Motion motion{rotation, direction / length};
      const double cost = truncatedCost(motion, limit_px);
      if (cost >= best_cost) continue;
      best_cost = cost;
      best = motion;
    }
    return best;
  }

  /// One Gauss-Newton step on rotation and direction with Cauchy weights.
  Motion refine(const Motion& motion, const TwoPointRansacOptions& options) const {
    using Vec5 = Eigen::Matrix<double, 5, 1>;
    Eigen::Matrix<double, 5, 5> hessian = Eigen::Matrix<double, 5, 5>::Zero();
    const double prior = 1.0 / (options.rotation_sigma_rad * options.rotation_sigma_rad);
    hessian.diagonal() << prior, prior, prior, 1.0, 1.0;
    Vec5 gradient = Vec5::Zero();
    const Mat32 basis = tangentBasis(motion.direction);
    for (size_t i = 0; i < current_.size(); ++i) {
      const Vec3 ray = motion.rotation * previous_[i];
      const Vec3 normal = motion.direction.cross(ray);
      const double scale = focal_px_ / std::max(normal.norm(), kNearEpipole);
      const double error = scale * normal.dot(current_[i]);
      Vec5 jacobian;
      jacobian.head<3>() = scale * ray.cross(current_[i].cross(motion.direction));
      jacobian.tail<2>() = scale * basis.transpose() * ray.cross(current_[i]);
      const double weight = 1.0 / (1.0 + error * error);
      hessian.noalias() += weight * jacobian * jacobian.transpose();
      gradient.noalias() += weight * error * jacobian;
    }
    const Vec5 step = -hessian.ldlt().solve(gradient);
    Motion next;
    next.rotation = so3::exp(step.head<3>()).toRotationMatrix() * motion.rotation;
    next.direction = (motion.direction + basis * step.tail<2>()).normalized();
    return next;
  }

 private:
  const std::vector<Vec3>& previous_;
  const std::vector<Vec3>& current_;
  double focal_px_;
};

}  // namespace

std::vector<bool> twoPointRansac(const std::vector<Vec3>& previous, const std::vector<Vec3>& current,
                                 const Mat3& current_from_previous, double focal_px,
                                 const TwoPointRansacOptions& options) {
  constexpr size_t kFewest = 8;
  constexpr int kRefinements = 5;
  const size_t n = current.size();
  std::vector<bool> agrees(n, true);
  if (n < kFewest) return agrees;

  const Consensus consensus(previous, current, focal_px);
  const double limit_px = options.max_error_px + focal_px * options.rotation_sigma_rad;
  Motion motion = consensus.bestHypothesis(current_from_previous, limit_px, options);
  for (int i = 0; i < kRefinements; ++i) {
    const Motion refined = consensus.refine(motion, options);
    if (consensus.truncatedCost(refined, limit_px) >= consensus.truncatedCost(motion, limit_px)) break;
    motion = refined;
  }
  for (size_t i = 0; i < n; ++i) agrees[i] = consensus.errorPx(motion, i) <= options.max_error_px;
  return agrees;
}

}  // namespace lodeline
