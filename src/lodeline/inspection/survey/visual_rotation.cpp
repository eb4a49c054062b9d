#include "lodeline/inspection/survey/visual_rotation.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

/// Scale of the robust loss, about a pixel: rays further from their plane have decreasing weight.
constexpr double kRobustScale_rad = 2e-3;
constexpr double kInlier_rad = 4e-3;
/// Typical flow without rotation between two images. Where points do not separate translation from rotation
/// well, the prior keeps the rotation near the one that explains most of the flow.
constexpr double kFlowSigma_rad = 0.05;
constexpr double kPrior = (kRobustScale_rad * kRobustScale_rad) / (kFlowSigma_rad * kFlowSigma_rad);

double robustWeight(double residual, double scale) {
  return 1.0 / (1.0 + residual * residual / (scale * scale));
}

/// The rotation R that minimizes the robust sum of |f1 - R f2|^2.
Quat alignedRotation(const std::vector<Vec3>& previous, const std::vector<Vec3>& current) {
  Quat rotation = Quat::Identity();
  double scale = 0.3;  // of all sizes at first: with a far too large scale all rays have the same weight
  for (int iteration = 0; iteration < 10; ++iteration) {
    Mat3 hessian = Mat3::Zero();
    Vec3 gradient = Vec3::Zero();
    for (size_t i = 0; i < previous.size(); ++i) {
      const Vec3 turned = rotation * current[i];
      const Vec3 residual = previous[i] - turned;
      const Mat3 jacobian = so3::skew(turned);  // of the residual, by a rotation vector on the left
      const double weight = robustWeight(residual.norm(), scale);
      hessian += weight * jacobian.transpose() * jacobian;
      gradient += weight * jacobian.transpose() * residual;
    }
    const Vec3 step = -hessian.ldlt().solve(gradient);
    if (!step.allFinite()) break;
    rotation = (so3::exp(step) * rotation).normalized();
    scale = std::max(0.01, 0.5 * scale);
  }
  return rotation;
}

/// Candidate directions, ordered by how close they are to the normal of all f1 x R f2, the closest first.
Mat3 translationDirections(const std::vector<Vec3>& previous, const std::vector<Vec3>& current,
                           const Quat& rotation) {
  Mat3 sum = Mat3::Zero();
  for (size_t i = 0; i < previous.size(); ++i) {
    const Vec3 normal = previous[i].cross(rotation * current[i]);
    sum += normal * normal.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Mat3>(sum).eigenvectors();
}

/// Motion of the camera up to the length of its translation, and the robust cost of the rays.
struct Motion {
  Quat rotation = Quat::Identity();
  Vec3 direction = Vec3::UnitX();
  double cost = std::numeric_limits<double>::infinity();
};

/// Distance of a point from the epipolar plane, approximately in rad.
double distanceFromPlane(const Vec3& previous, const Vec3& current, const Motion& motion) {
  return previous.dot(motion.direction.cross(motion.rotation * current));
}

/// Gauss-Newton from an initial value. Rotation and direction are updated together, because alternate updates
/// converge very slowly along the direction in which both compensate each other. `first_scale_rad`: initial
/// scale of the robust loss, halved down to the final one, so that points are not rejected before the
/// translation is known.
Motion refine(const std::vector<Vec3>& previous, const std::vector<Vec3>& current, const Quat& start,
              const Vec3& direction, double first_scale_rad) {
  using Step = Eigen::Matrix<double, 5, 1>;
  Motion motion{start, direction, 0.0};
  for (int iteration = 0; iteration < 25; ++iteration) {
    const double scale_rad = std::max(kRobustScale_rad, first_scale_rad * std::pow(0.5, iteration));
    const Mat32 tangent = tangentBasis(motion.direction);
    const Vec3 from_start = so3::log(motion.rotation * start.conjugate());
    Eigen::Matrix<double, 5, 5> hessian = 1e-9 * Eigen::Matrix<double, 5, 5>::Identity();
    Step gradient = Step::Zero();
    hessian.topLeftCorner<3, 3>() += kPrior * Mat3::Identity();
    gradient.head<3>() = kPrior * from_start;
    motion.cost = kPrior * from_start.squaredNorm();
    for (size_t i = 0; i < previous.size(); ++i) {
      const Vec3 turned = motion.rotation * current[i];
      const double residual = distanceFromPlane(previous[i], current[i], motion);
      Step jacobian;
      jacobian.head<3>() = turned.cross(previous[i].cross(motion.direction));
      jacobian.tail<2>() = tangent.transpose() * turned.cross(previous[i]);
      const double weight = robustWeight(residual, scale_rad);
      hessian += weight * jacobian * jacobian.transpose();
      gradient += weight * jacobian * residual;
      motion.cost -= kRobustScale_rad * kRobustScale_rad * std::log(robustWeight(residual, kRobustScale_rad));
    }
    const Step step = -hessian.ldlt().solve(gradient);
    if (!step.allFinite()) return {};
    if (step.norm() < 1e-7 && scale_rad == kRobustScale_rad) break;
    motion.rotation = (so3::exp(step.head<3>()) * motion.rotation).normalized();
    motion.direction = (motion.direction + tangent * step.tail<2>()).normalized();
  }
  return motion;
}

}  // namespace

std::optional<VisualRotation> visualRotation(const std::vector<Vec3>& previous,
                                             const std::vector<Vec3>& current, int least_points) {
  if (static_cast<int>(previous.size()) < least_points) return std::nullopt;
  const Quat start = alignedRotation(previous, current);
  const Mat3 directions = translationDirections(previous, current, start);
  Motion best;
  for (int i = 0; i < 3; ++i) {
    for (const double first_scale_rad : {kRobustScale_rad, kFlowSigma_rad}) {
      const Motion motion = refine(previous, current, start, directions.col(i), first_scale_rad);
      if (motion.cost < best.cost) best = motion;
    }
  }
  VisualRotation result;
  double squares = 0.0;
  for (size_t i = 0; i < previous.size(); ++i) {
    const double distance = distanceFromPlane(previous[i], current[i], best);
    if (std::abs(distance) > kInlier_rad) continue;
    ++result.points;
    squares += distance * distance;
  }
  if (result.points < least_points) return std::nullopt;
  result.rotation_C = so3::log(best.rotation);
  result.rms_rad = std::sqrt(squares / result.points);
  return result;
}

}  // namespace lodeline
