#pragma once

#include <vector>

#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// Divides the view of a keyframe into about 48 square cells that contain features.
///
/// The view is the set of the features' directions. They are laid into a plane at equal angles from their
/// mean direction, so that neither the calibration nor the number of images matters.
class ViewGrid {
 public:
  explicit ViewGrid(const MapKeyframe& keyframe);

  int cellOf(int feature) const { return cells_[static_cast<size_t>(feature)]; }
  int occupiedCells() const { return occupied_; }
  /// Of the cells that contain features, sr.
  double solidAngle_sr() const { return solid_angle_sr_; }
  /// Cells that contain any of these features.
  int countCells(const std::vector<int>& features) const;

 private:
  std::vector<int> cells_;  ///< of each feature
  int occupied_ = 0;
  double solid_angle_sr_ = 0.0;
};

}  // namespace lodeline
