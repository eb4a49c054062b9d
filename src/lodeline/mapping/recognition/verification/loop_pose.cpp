#include "lodeline/mapping/recognition/verification/loop_pose.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;

Rigid3 moved(const Rigid3& pose, const Vec6& step) {
  return {(so3::exp(step.tail<3>()) * pose.rotation).normalized(), pose.translation + step.head<3>()};
}

struct PoseEquations {
  Mat6 information = Mat6::Zero();
  Vec6 gradient = Vec6::Zero();
  double cost = 0.0;
};

/// Adds the terms at a pose. The Cauchy loss of width c costs c^2 log(1 + s / c^2) and weights with
/// 1 / (1 + s / c^2). Its width is the inliers' gate. A pair that the pose places out of sight costs as one
/// at the edge of sight.
PoseEquations linearizeAt(const std::vector<LoopCorrespondence>& pairs, const std::vector<bool>& is_used,
                          const CommonVertical& vertical, const Rigid3& pose) {
  constexpr double kOutOfSight = 1e4;
  PoseEquations result;
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (!is_used[i]) continue;
    const LoopResidual residual = residualOf(pairs[i], pose, true);
    const double width2 = gateOf(residual.rows);
    const double squared = residual.is_valid ? residual.squared() : kOutOfSight;
    result.cost += width2 * std::log1p(squared / width2);
    if (!residual.is_valid) continue;
    const double weight = 1.0 / (1.0 + squared / width2);
    result.information += weight * residual.by_pose.transpose() * residual.by_pose;
    result.gradient += weight * residual.by_pose.transpose() * residual.whitened;
  }
  Eigen::Matrix<double, 2, 6> by_pose;
  const Vec2 tilt = vertical.residual(pose.rotation, &by_pose);
  result.cost += tilt.squaredNorm();
  result.information += by_pose.transpose() * by_pose;
  result.gradient += by_pose.transpose() * tilt;
  return result;
}

}  // namespace

Vec2 CommonVertical::residual(const Quat& old_from_new, Eigen::Matrix<double, 2, 6>* by_pose) const {
  const Mat32 horizontal = tangentBasis(up_old);
  const Vec3 turned = old_from_new * up_new;
  by_pose->setZero();
  by_pose->rightCols<3>() = -horizontal.transpose() * so3::skew(turned) / sigma_rad;
  return horizontal.transpose() * turned / sigma_rad;
}

RefinedPose refinePose(const std::vector<LoopCorrespondence>& pairs, const std::vector<bool>& is_used,
                       const CommonVertical& vertical, const Rigid3& start, int iterations) {
  constexpr double kSmallStep = 1e-9;
  RefinedPose result;
  result.old_from_new = start;
  PoseEquations present = linearizeAt(pairs, is_used, vertical, start);
  double damping = 1e-6;
  for (int i = 0; i < iterations; ++i) {
    Mat6 damped = present.information;
    damped.diagonal() *= 1.0 + damping;
    const Vec6 step = -damped.ldlt().solve(present.gradient);
    if (!step.allFinite()) break;
    const Rigid3 next = moved(result.old_from_new, step);
    PoseEquations there = linearizeAt(pairs, is_used, vertical, next);
    if (there.cost <= present.cost) {
      result.old_from_new = next;
      present = there;
      damping *= 0.1;
    } else {
      damping = std::max(1e-4, damping * 20.0);
    }
    if (step.norm() < kSmallStep) break;
  }
  result.information = present.information;
  const Eigen::SelfAdjointEigenSolver<Mat6> eigen(result.information);
  result.is_determined = eigen.eigenvalues()(0) > 1e-10 * eigen.eigenvalues()(5);
  return result;
}

Mat6 informationOfStructure(const std::vector<LoopCorrespondence>& pairs, const std::vector<bool>& is_used,
                            const RefinedPose& pose) {
  constexpr double kLeast = 1e-3;
  Mat6 noise = Mat6::Zero();
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (!is_used[i]) continue;
    const auto jacobian = [&](double sigmas) {
      LoopCorrespondence moved_pair = pairs[i];
      PointObservation& point = moved_pair.is_point_old ? moved_pair.in_old : moved_pair.in_new;
      point.point_B += sigmas * point.distance_sigma_m * point.bearing_B;
      return residualOf(moved_pair, pose.old_from_new, true).by_pose;
    };
    const Eigen::Matrix<double, 3, 6> change = 0.5 * (jacobian(1.0) - jacobian(-1.0));
    noise += change.transpose() * change;
  }
  // Coordinates in which the information is the identity.
  const Eigen::LLT<Mat6> root(pose.information);
  const Mat6 relative = root.matrixL().solve(Mat6(root.matrixL().solve(noise).transpose()));
  const Eigen::SelfAdjointEigenSolver<Mat6> eigen(relative);
  const Eigen::Matrix<double, 6, 1> left = (1.0 - eigen.eigenvalues().array()).cwiseMax(kLeast);
  const Mat6 factor = Mat6(root.matrixL()) * eigen.eigenvectors();
  return factor * left.asDiagonal() * factor.transpose();
}

double designEffect(const std::vector<LoopCorrespondence>& pairs, const std::vector<bool>& is_used,
                    const std::vector<int>& groups, const RefinedPose& pose) {
  std::map<int, Vec6> sums;
  double rows = 0.0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (!is_used[i]) continue;
    const LoopResidual residual = residualOf(pairs[i], pose.old_from_new, true);
    if (!residual.is_valid) continue;
    Vec6& sum = sums.try_emplace(groups[i], Vec6::Zero()).first->second;
    sum += residual.by_pose.transpose() * residual.whitened;
    rows += residual.rows;
  }
  constexpr double kCoordinates = 6.0;
  const auto count = static_cast<double>(sums.size());
  if (count < 2.0 || rows <= kCoordinates + 1.0) return 1.0;
  Mat6 spread = Mat6::Zero();
  for (const auto& [group, sum] : sums) spread += sum * sum.transpose();
  // The pose has taken six of the residuals' degrees of freedom, and the groups' sums add up to nearly zero.
  const double small_sample = count / (count - 1.0) * (rows - 1.0) / (rows - kCoordinates);
  return std::max(1.0, small_sample * pose.information.ldlt().solve(spread).trace() / kCoordinates);
}

}  // namespace lodeline
