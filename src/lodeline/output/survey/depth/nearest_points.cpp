#include "lodeline/output/survey/depth/nearest_points.h"

#include <nanoflann.hpp>

namespace lodeline {

struct NearestPoints::Index {
  /// Points in the interface of nanoflann.
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

  explicit Index(const std::vector<Vec3>& points) : cloud{points}, tree(3, cloud) {}

  Cloud cloud;
  Tree tree;
};

NearestPoints::NearestPoints(const std::vector<Vec3>& points) : index_(std::make_unique<Index>(points)) {}
NearestPoints::~NearestPoints() = default;

std::vector<size_t> NearestPoints::find(const Vec3& place, size_t count) const {
  std::vector<size_t> indices(count);
  std::vector<double> squared_distances(count);
  indices.resize(index_->tree.knnSearch(place.data(), count, indices.data(), squared_distances.data()));
  return indices;
}

}  // namespace lodeline
