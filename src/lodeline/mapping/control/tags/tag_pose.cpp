#include "lodeline/mapping/control/tags/tag_pose.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <utility>
#include <vector>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using Parameters = std::array<double, 6>;  ///< angle-axis and translation of camera_from_tag

/// The corners of a square of that size in its frame.
std::array<Vec3, 4> cornersOfSquare(double size_m) {
  const double half_m = 0.5 * size_m;
  return {Vec3(-half_m, -half_m, 0), Vec3(half_m, -half_m, 0), Vec3(half_m, half_m, 0),
          Vec3(-half_m, half_m, 0)};
}

/// The two components across the ray of the direction from the ray's origin to a corner, over the ray's
/// sigma.
struct CornerResidual {
  Vec3 corner_T;
  BodyRay ray;

  template <typename T>
  bool operator()(const T* pose, T* residual) const {
    const T corner[3] = {T(corner_T.x()), T(corner_T.y()), T(corner_T.z())};
    T turned[3];
    ceres::AngleAxisRotatePoint(pose, corner, turned);
    Eigen::Matrix<T, 3, 1> direction;
    for (int i = 0; i < 3; ++i) direction[i] = turned[i] + pose[3 + i] - T(ray.origin_B[i]);
    Eigen::Map<Eigen::Matrix<T, 2, 1>> across(residual);
    across = tangentBasis(ray.bearing_B).transpose().cast<T>() * direction.normalized() / T(ray.sigma_rad);
    return true;
  }
};

/// Rotation from the frame of the rays to one whose z axis is the mean bearing.
Mat3 viewFrame(const std::array<BodyRay, 4>& corners) {
  Vec3 mean = Vec3::Zero();
  for (const BodyRay& ray : corners) mean += ray.bearing_B;
  mean.normalize();
  Mat3 view_from_body;
  view_from_body << tangentBasis(mean).transpose(), mean.transpose();
  // The basis and the mean are right-handed or left-handed by the half space of the mean.
  if (view_from_body.determinant() < 0.0) view_from_body.row(0) *= -1.0;
  return view_from_body;
}

/// The poses of a flat square that a perspective view allows: usually two.
std::vector<Parameters> startsOf(const std::array<BodyRay, 4>& corners, double size_m) {
  const Mat3 view_from_body = viewFrame(corners);
  std::vector<cv::Point3d> on_tag;
  std::vector<cv::Point2d> in_view;
  for (const Vec3& corner : cornersOfSquare(size_m)) on_tag.emplace_back(corner.x(), corner.y(), 0.0);
  for (const BodyRay& ray : corners) {
    const Vec3 bearing = view_from_body * ray.bearing_B;
    if (bearing.z() < 0.2) return {};
    in_view.emplace_back(bearing.x() / bearing.z(), bearing.y() / bearing.z());
  }
  std::vector<cv::Mat> rotations, translations;
  try {
    cv::solvePnPGeneric(on_tag, in_view, cv::Matx33d::eye(), cv::noArray(), rotations, translations, false,
                        cv::SOLVEPNP_IPPE);
  } catch (const cv::Exception&) {  // corners on a line
    return {};
  }
  std::vector<Parameters> starts;
  for (size_t i = 0; i < rotations.size(); ++i) {
    const auto* turn = rotations[i].ptr<double>();
    const auto* shift = translations[i].ptr<double>();
    const Mat3 body_from_tag =
        view_from_body.transpose() * so3::exp(Vec3(turn[0], turn[1], turn[2])).toRotationMatrix();
    const Vec3 turn_B = so3::log(Quat(body_from_tag));
    const Vec3 centre_B =
        view_from_body.transpose() * Vec3(shift[0], shift[1], shift[2]) + corners[0].origin_B;
    starts.push_back({turn_B.x(), turn_B.y(), turn_B.z(), centre_B.x(), centre_B.y(), centre_B.z()});
  }
  return starts;
}

/// Improves a start; returns nothing where the solution is not determined.
std::optional<TagPose> solvedPose(Parameters pose, const std::array<BodyRay, 4>& corners, double size_m) {
  ceres::Problem problem;
  const std::array<Vec3, 4> corners_T = cornersOfSquare(size_m);
  for (size_t k = 0; k < 4; ++k) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<CornerResidual, 2, 6>(new CornerResidual{corners_T[k], corners[k]}),
        nullptr, pose.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  ceres::Covariance covariance{ceres::Covariance::Options()};
  std::array<double, 36> values;
  if (!summary.IsSolutionUsable() ||
      !covariance.Compute(std::vector<std::pair<const double*, const double*>>{{pose.data(), pose.data()}},
                          &problem))
    return std::nullopt;
  covariance.GetCovarianceBlock(pose.data(), pose.data(), values.data());
  TagPose result;
  result.centre_B.position = Vec3(pose[3], pose[4], pose[5]);
  result.centre_B.covariance = Eigen::Map<const Mat6>(values.data()).bottomRightCorner<3, 3>();
  result.body_from_tag = Rigid3(so3::exp(Vec3(pose[0], pose[1], pose[2])), result.centre_B.position);
  result.rms_sigmas = std::sqrt(2.0 * summary.final_cost / 8.0);
  // The tag must be in front of the camera and show its print.
  const Vec3 to_tag = result.centre_B.position - corners[0].origin_B;
  if (to_tag.dot(corners[0].bearing_B) <= 0.0) return std::nullopt;
  if ((result.body_from_tag.rotation * Vec3::UnitZ()).dot(to_tag) >= 0.0) return std::nullopt;
  return result;
}

}  // namespace

std::optional<TagPose> tagPose(const std::array<BodyRay, 4>& corners, double size_m) {
  std::optional<TagPose> best;
  for (const Parameters& start : startsOf(corners, size_m)) {
    const std::optional<TagPose> pose = solvedPose(start, corners, size_m);
    if (pose && (!best || pose->rms_sigmas < best->rms_sigmas)) best = pose;
  }
  return best;
}

}  // namespace lodeline
