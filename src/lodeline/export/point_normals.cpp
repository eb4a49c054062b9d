#include "lodeline/export/point_normals.h"

#include <Eigen/Eigenvalues>
#include <array>
#include <nanoflann.hpp>

namespace lodeline {
namespace {

/// Points as nanoflann wants to see them.
struct Cloud {
  const std::vector<Vec3>& points;

  size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(size_t i, size_t axis) const { return points[i][static_cast<Eigen::Index>(axis)]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, size_t>;

constexpr size_t kNeighbours = 12;  ///< the point itself among them

/// Direction in which the neighbours scatter least; zero where they do not span a plane.
Vec3 planeNormal(const std::vector<Vec3>& points, const std::array<size_t, kNeighbours>& neighbours,
                 size_t count) {
  if (count < 4) return Vec3::Zero();
  Vec3 mean = Vec3::Zero();
  for (size_t i = 0; i < count; ++i) mean += points[neighbours[i]] / static_cast<double>(count);
  Mat3 scatter = Mat3::Zero();
  for (size_t i = 0; i < count; ++i) {
    const Vec3 offset = points[neighbours[i]] - mean;
    scatter += offset * offset.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(scatter);
  if (solver.eigenvalues()[1] <= 1e-6 * solver.eigenvalues()[2]) return Vec3::Zero();
  return solver.eigenvectors().col(0);
}

}  // namespace

std::vector<Vec3> normalsTowards(const std::vector<Vec3>& points, const std::vector<Vec3>& viewpoints) {
  const Cloud cloud{points}, views{viewpoints};
  const Tree tree(3, cloud), view_tree(3, views);
  std::vector<Vec3> normals;
  normals.reserve(points.size());
  std::array<size_t, kNeighbours> neighbours;
  std::array<double, kNeighbours> squared_distances;
  for (const Vec3& point : points) {
    size_t nearest_view = 0;
    view_tree.knnSearch(point.data(), 1, &nearest_view, squared_distances.data());
    const Vec3 to_view = viewpoints[nearest_view] - point;
    const size_t count =
        tree.knnSearch(point.data(), kNeighbours, neighbours.data(), squared_distances.data());
    Vec3 normal = planeNormal(points, neighbours, count);
    if (normal.isZero()) normal = to_view.norm() > 0.0 ? Vec3(to_view.normalized()) : Vec3(Vec3::UnitZ());
    normals.push_back(normal.dot(to_view) < 0.0 ? Vec3(-normal) : normal);
  }
  return normals;
}

}  // namespace lodeline
