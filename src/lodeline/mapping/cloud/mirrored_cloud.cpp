#include "lodeline/mapping/cloud/mirrored_cloud.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

/// The cloud under the linear map about a centre; the map is orthogonal.
LocalCloud mappedCloud(const LocalCloud& cloud, const Vec3& centre, const Mat3& map) {
  LocalCloud result = cloud;
  for (CloudPoint& point : result.points) {
    point.position_F = centre + map * (point.position_F - centre);
    point.covariance_F = map * point.covariance_F * map.transpose();
    point.view_F = map * point.view_F;
    point.normal_F = map * point.normal_F;
  }
  return result;
}

}  // namespace

std::array<LocalCloud, 3> mirroredClouds(const LocalCloud& cloud) {
  Vec3 centre = Vec3::Zero();
  for (const CloudPoint& point : cloud.points) centre += point.position_F;
  centre /= std::max<double>(1.0, static_cast<double>(cloud.points.size()));
  const Mat32 axes = tangentBasis(cloud.up_F);
  Mat2 scatter = Mat2::Zero();
  for (const CloudPoint& point : cloud.points) {
    const Vec2 arm = axes.transpose() * (point.position_F - centre);
    scatter += arm * arm.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat2> solver(scatter);
  const Vec3 side = axes * solver.eigenvectors().col(0);
  const Vec3 front = axes * solver.eigenvectors().col(1);
  const Mat3 left_right = Mat3::Identity() - 2.0 * side * side.transpose();
  const Mat3 front_back = Mat3::Identity() - 2.0 * front * front.transpose();
  return {mappedCloud(cloud, centre, left_right), mappedCloud(cloud, centre, front_back),
          mappedCloud(cloud, centre, left_right * front_back)};
}

}  // namespace lodeline
