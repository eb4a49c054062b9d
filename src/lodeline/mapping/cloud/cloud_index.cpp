#include "lodeline/mapping/cloud/cloud_index.h"

#include <algorithm>
#include <nanoflann.hpp>
#include <utility>

namespace lodeline {

struct CloudIndex::Tree {
  /// Points in the interface of nanoflann.
  struct Positions {
    std::vector<Vec3> points;

    size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(size_t i, size_t axis) const { return points[i][static_cast<Eigen::Index>(axis)]; }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  using Search = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Positions>,
                                                     Positions, 3, size_t>;

  explicit Tree(std::vector<Vec3> points) : positions{std::move(points)}, search(3, positions) {}

  Positions positions;
  Search search;
};

CloudIndex::CloudIndex(std::vector<Vec3> positions) {
  if (!positions.empty()) tree_ = std::make_unique<Tree>(std::move(positions));
}
CloudIndex::~CloudIndex() = default;
CloudIndex::CloudIndex(CloudIndex&&) noexcept = default;
CloudIndex& CloudIndex::operator=(CloudIndex&&) noexcept = default;

void CloudIndex::find(const Vec3& place, size_t count, std::vector<Neighbour>& found) const {
  found.clear();
  if (!tree_ || count == 0) return;
  constexpr size_t kMost = 32;
  size_t indices[kMost];
  double squared_distances[kMost];
  const size_t number =
      tree_->search.knnSearch(place.data(), std::min(count, kMost), indices, squared_distances);
  for (size_t i = 0; i < number; ++i) found.push_back({indices[i], squared_distances[i]});
  std::sort(found.begin(), found.end(), [](const Neighbour& a, const Neighbour& b) {
    return std::pair(a.squared_distance, a.index) < std::pair(b.squared_distance, b.index);
  });
}

}  // namespace lodeline
