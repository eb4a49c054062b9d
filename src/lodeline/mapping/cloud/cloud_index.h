#pragma once

#include <memory>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// A point among others and its squared distance, m^2.
struct Neighbour {
  size_t index = 0;
  double squared_distance = 0.0;
};

/// Search for the nearest of the points of a cloud.
class CloudIndex {
 public:
  /// Copies the positions. There may be none.
  explicit CloudIndex(std::vector<Vec3> positions);
  ~CloudIndex();
  CloudIndex(CloudIndex&&) noexcept;
  CloudIndex& operator=(CloudIndex&&) noexcept;

  /// The `count` points (or all, where there are fewer) nearest to a place, nearest first. Points at equal
  /// distances are ordered by their index.
  void find(const Vec3& place, size_t count, std::vector<Neighbour>& found) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace lodeline
