#include "lodeline/output/survey/formats/point_normals.h"

#include <Eigen/Eigenvalues>

#include "lodeline/output/survey/depth/nearest_points.h"

namespace lodeline {
namespace {

constexpr size_t kNeighbours = 12;  ///< the point itself among them

/// Direction of smallest scatter of the neighbours; zero where they do not span a plane.
Vec3 planeNormal(const std::vector<Vec3>& points, const std::vector<size_t>& neighbours) {
  if (neighbours.size() < 4) return Vec3::Zero();
  Vec3 mean = Vec3::Zero();
  for (size_t i : neighbours) mean += points[i] / static_cast<double>(neighbours.size());
  Mat3 scatter = Mat3::Zero();
  for (size_t i : neighbours) {
    const Vec3 offset = points[i] - mean;
    scatter += offset * offset.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(scatter);
  if (solver.eigenvalues()[1] <= 1e-6 * solver.eigenvalues()[2]) return Vec3::Zero();
  return solver.eigenvectors().col(0);
}

}  // namespace

std::vector<Vec3> normalsTowards(const std::vector<Vec3>& points, const std::vector<Vec3>& viewpoints) {
  std::vector<Vec3> normals;
  if (points.empty()) return normals;
  const NearestPoints near_points(points), near_views(viewpoints);
  normals.reserve(points.size());
  for (const Vec3& point : points) {
    const Vec3 to_view = viewpoints[near_views.find(point, 1).front()] - point;
    Vec3 normal = planeNormal(points, near_points.find(point, kNeighbours));
    if (normal.isZero()) normal = to_view.norm() > 0.0 ? Vec3(to_view.normalized()) : Vec3(Vec3::UnitZ());
    normals.push_back(normal.dot(to_view) < 0.0 ? Vec3(-normal) : normal);
  }
  return normals;
}

}  // namespace lodeline
