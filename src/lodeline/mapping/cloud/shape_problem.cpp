#include "lodeline/mapping/cloud/shape_problem.h"

#include <cmath>

#include "lodeline/geometry/so3.h"
#include "lodeline/geometry/squared.h"

namespace lodeline {

ShapeProblem::ShapeProblem(const LocalCloud& old_cloud, const LocalCloud& new_cloud, int neighbours)
    : old_(old_cloud),
      new_(new_cloud),
      surface_(old_cloud, neighbours),
      horizontal_(tangentBasis(old_.up_F)) {
  for (const CloudPoint& point : new_.points) centroid_N_ += point.position_F;
  if (!new_.points.empty()) centroid_N_ /= static_cast<double>(new_.points.size());
}

std::vector<ShapeRow> ShapeProblem::rows(const ShapeState& state, size_t stride) const {
  const Mat3 rotation = state.old_from_new.rotation.toRotationMatrix();
  const Vec3 centroid = state.old_from_new * centroid_N_;
  std::vector<ShapeRow> rows;
  rows.reserve(size() / stride + 1);
  for (size_t i = 0; i < size(); i += stride) {
    const CloudPoint& point = new_.points[i];
    const Vec3 place = rotation * point.position_F + state.old_from_new.translation;
    const auto surface =
        surface_.at(place, rotation * point.normal_F, rotation * point.covariance_F * rotation.transpose());
    if (!surface) continue;
    const Vec3 arm = place - centroid;
    ShapeRow row;
    row.point = i;
    row.error = (surface->distance_m + state.offset_m) / surface->sigma_m;
    row.jacobian << surface->normal, old_.up_F.dot(arm.cross(surface->normal)), 1.0;
    row.jacobian /= surface->sigma_m;
    Eigen::Matrix<double, 4, 3> by_normal;
    by_normal << Mat3::Identity(), old_.up_F.cross(arm).transpose();
    row.slope_noise =
        by_normal * surface->tilt_covariance * by_normal.transpose() / squared(surface->sigma_m);
    row.considered << -surface->normal.dot(surface->view), surface->normal.dot(rotation * point.view_F),
        horizontal_.transpose() * arm.cross(surface->normal);
    row.considered /= surface->sigma_m;
    rows.push_back(row);
  }
  return rows;
}

ShapeState ShapeProblem::moved(const ShapeState& state, const Vec5& step) const {
  const Vec3 centroid = state.old_from_new * centroid_N_ + step.head<3>();
  const Quat rotation = (so3::exp(step[3] * old_.up_F) * state.old_from_new.rotation).normalized();
  return {Rigid3(rotation, centroid - rotation * centroid_N_), state.offset_m + step[4]};
}

Vec4 ShapeProblem::difference(const Rigid3& from, const Rigid3& to) const {
  Vec4 result;
  result << to * centroid_N_ - from * centroid_N_,
      old_.up_F.dot(so3::log(to.rotation * from.rotation.conjugate()));
  return result;
}

Mat46 ShapeProblem::parametersByPose(const Rigid3& old_from_new) const {
  Mat46 result = Mat46::Zero();
  result.block<3, 3>(0, 0).setIdentity();
  result.block<3, 3>(0, 3) = -so3::skew(old_from_new.rotation * centroid_N_);
  result.block<1, 3>(3, 3) = old_.up_F.transpose();
  return result;
}

Rigid3 ShapeProblem::upright(const Rigid3& old_from_new, double& tilt_rad) const {
  const Vec3 up = old_from_new.rotation * new_.up_F;
  const Vec3 axis = up.cross(old_.up_F);
  tilt_rad = std::atan2(axis.norm(), up.dot(old_.up_F));
  const Quat correction = so3::exp(axis.norm() > 1e-12 ? Vec3(tilt_rad * axis.normalized()) : Vec3::Zero());
  const Vec3 centroid = old_from_new * centroid_N_;
  const Quat rotation = (correction * old_from_new.rotation).normalized();
  return Rigid3(rotation, centroid - rotation * centroid_N_);
}

}  // namespace lodeline
