#pragma once

#include <memory>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Nearest-neighbour search among many points.
class NearestPoints {
 public:
  /// `points` must outlive the object and not be empty.
  explicit NearestPoints(const std::vector<Vec3>& points);
  ~NearestPoints();

  /// Indices of the `count` points (or all, where there are fewer) nearest to a position, nearest first.
  std::vector<size_t> find(const Vec3& place, size_t count) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace lodeline
