#include "lodeline/output/walls/fusion/canonical_mesh.h"

#include <algorithm>
#include <numeric>

namespace lodeline {
namespace {

/// The same mesh with vertices by rising coordinates, equal ones joined, and triangles in order.
WallMesh sorted(const WallMesh& mesh) {
  std::vector<uint32_t> order(mesh.vertices());
  std::iota(order.begin(), order.end(), 0U);
  const auto isBefore = [&](uint32_t a, uint32_t b) {
    const WallMesh::Point &p = mesh.positions[a], &q = mesh.positions[b];
    return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
  };
  std::sort(order.begin(), order.end(), isBefore);
  WallMesh result;
  std::vector<uint32_t> place(mesh.vertices());
  for (const uint32_t i : order) {
    if (result.positions.empty() || result.positions.back() != mesh.positions[i]) {
      result.positions.push_back(mesh.positions[i]);
      result.colours.push_back(mesh.colours[i]);
      result.views.push_back(mesh.views[i]);
    }
    place[i] = static_cast<uint32_t>(result.positions.size() - 1);
  }
  for (const auto& triangle : mesh.triangles) {
    std::array<uint32_t, 3> corners = {place[triangle[0]], place[triangle[1]], place[triangle[2]]};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    result.triangles.push_back(corners);
  }
  std::sort(result.triangles.begin(), result.triangles.end());
  return result;
}

/// Parts of a mesh that share no vertex.
class Parts {
 public:
  explicit Parts(const WallMesh& mesh) : parents_(mesh.vertices()) {
    std::iota(parents_.begin(), parents_.end(), 0U);
    for (const auto& [a, b, c] : mesh.triangles) {
      join(a, b);
      join(b, c);
    }
  }
  uint32_t of(uint32_t vertex) {
    while (parents_[vertex] != vertex) vertex = parents_[vertex] = parents_[parents_[vertex]];
    return vertex;
  }

 private:
  void join(uint32_t a, uint32_t b) {
    const uint32_t first = of(a), second = of(b);
    parents_[std::max(first, second)] = std::min(first, second);
  }

  std::vector<uint32_t> parents_;
};

}  // namespace

WallMesh canonicalMesh(const WallMesh& mesh, const Tile& tile, const FusionOptions& options) {
  WallMesh result = sorted(mesh);
  result.computeNormals();
  const auto block_m = static_cast<float>(options.block_m());
  const auto isInside = [&](const WallMesh::Point& point) {
    return tile.contains((point / block_m).array().floor().cast<int>().matrix());
  };
  Parts parts(result);
  std::vector<size_t> sizes(result.vertices(), 0);
  std::vector<uint8_t> goes_on(result.vertices(), 0);
  for (const auto& triangle : result.triangles) ++sizes[parts.of(triangle[0])];
  for (uint32_t i = 0; i < result.vertices(); ++i) {
    if (!isInside(result.positions[i])) goes_on[parts.of(i)] = 1;
  }
  std::vector<std::array<uint32_t, 3>> kept;
  for (const auto& triangle : result.triangles) {
    const uint32_t part = parts.of(triangle[0]);
    if (sizes[part] < options.min_part_triangles && goes_on[part] == 0) continue;
    const WallMesh::Point middle =
        (result.positions[triangle[0]] + result.positions[triangle[1]] + result.positions[triangle[2]]) /
        3.0F;
    if (isInside(middle)) kept.push_back(triangle);
  }
  result.triangles = std::move(kept);
  result.removeUnused();
  return result;
}

}  // namespace lodeline
