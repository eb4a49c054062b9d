#pragma once

#include <optional>
#include <vector>

#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// Distance that the tracked points of a keyframe let expect at a pixel.
struct ExpectedDistance {
  double distance_m = 2.0;
  /// Standard deviation relative to the distance, where the points around the pixel lie on one surface; empty
  /// where they do not, or are too far from it.
  std::optional<double> relative_sigma;
};

/// Distances between the tracked points of a keyframe, in the image of camera 0.
class SceneDistance {
 public:
  /// `focal_px`: of camera 0. Features without a position are passed over.
  SceneDistance(const std::vector<MapFeature>& tracked, double focal_px);

  /// Mean of the inverse distances of the nearest points, the nearer ones with more weight.
  ExpectedDistance at(const Vec2& pixel) const;

 private:
  struct Point {
    Vec2 pixel = Vec2::Zero();
    double inverse_per_m = 0.0;
  };
  std::vector<Point> points_;
  double focal_px_;
};

}  // namespace lodeline
