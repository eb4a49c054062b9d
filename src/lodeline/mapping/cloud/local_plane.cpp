#include "lodeline/mapping/cloud/local_plane.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "lodeline/geometry/squared.h"

namespace lodeline {
namespace {

constexpr size_t kLeastPlanePoints = 6;

/// Weighted mean, scatter and effective number of neighbours.
struct PlaneMoments {
  Vec3 centroid = Vec3::Zero();
  Vec3 view = Vec3::Zero();
  Mat3 noise = Mat3::Zero();
  Mat3 scatter = Mat3::Zero();
  double number = 0.0;
};

PlaneMoments momentsOf(const LocalCloud& cloud, const std::vector<Neighbour>& neighbours) {
  // The farthest would get the weight zero: the limit lies a little beyond it.
  const double limit = 1.1 * neighbours.back().squared_distance + 1e-12;
  PlaneMoments moments;
  double sum = 0.0, sum_of_squares = 0.0;
  for (const Neighbour& neighbour : neighbours) {
    const double weight = squared(1.0 - neighbour.squared_distance / limit);
    sum += weight;
    sum_of_squares += squared(weight);
    moments.centroid += weight * cloud.points[neighbour.index].position_F;
    moments.view += weight * cloud.points[neighbour.index].view_F;
  }
  moments.centroid /= sum;
  moments.view /= sum;
  for (const Neighbour& neighbour : neighbours) {
    const double weight = squared(1.0 - neighbour.squared_distance / limit) / sum;
    const Vec3 arm = cloud.points[neighbour.index].position_F - moments.centroid;
    moments.scatter += weight * arm * arm.transpose();
    moments.noise += weight * cloud.points[neighbour.index].covariance_F;
  }
  moments.number = squared(sum) / sum_of_squares;
  return moments;
}

}  // namespace

std::optional<LocalPlane> fitLocalPlane(const LocalCloud& cloud, const CloudIndex& index, const Vec3& place,
                                        int count, std::vector<Neighbour>& work) {
  index.find(place, static_cast<size_t>(count), work);
  if (work.size() < kLeastPlanePoints) return std::nullopt;
  const PlaneMoments moments = momentsOf(cloud, work);
  if (moments.number <= 3.5) return std::nullopt;
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(moments.scatter);
  const Vec3 variances = solver.eigenvalues().cwiseMax(1e-12);
  if (variances[1] < 1e-6) return std::nullopt;

  LocalPlane plane;
  plane.centroid = moments.centroid;
  plane.view = moments.view;
  plane.normal = solver.eigenvectors().col(0).normalized();
  if (plane.normal.dot(moments.view) > 0.0) plane.normal = -plane.normal;
  // A plane takes three degrees of freedom.
  plane.thickness_squared_m2 = variances[0] * moments.number / (moments.number - 3.0);
  plane.noise_squared_m2 = plane.normal.dot(moments.noise * plane.normal);
  plane.flatness = 1.0 - std::min(1.0, variances[0] / variances[1]);
  double leverage = 1.0;
  for (int i = 1; i < 3; ++i) {
    const Vec3 tangent = solver.eigenvectors().col(i);
    leverage += squared(tangent.dot(place - plane.centroid)) / variances[i];
    plane.tilt_covariance +=
        plane.thickness_squared_m2 / (moments.number * variances[i]) * tangent * tangent.transpose();
  }
  plane.leverage = leverage / moments.number;
  return plane;
}

}  // namespace lodeline
