#pragma once

#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// A point near a beam, in the axes of the beam: its directions across over its distance along, 1 over that
/// distance (1/m), and its weight.
struct BeamPoint {
  double across_1 = 0.0, across_2 = 0.0;
  double inverse_distance_per_m = 0.0;
  double weight = 1.0;
};

/// Distance along a beam to the plane through points near it. The directions a and b are the distances
/// across the beam over the distance along it. There a plane has exactly the inverse distance
///   y = w_0 + w_1 a + w_2 b,
/// The weighted least squares of the points' y give w, and the beam (a = b = 0) meets the plane at the
/// distance 1 / w_0.
class BeamSurface {
 public:
  /// The weights may have any scale. Three points that are not on a line determine the plane.
  explicit BeamSurface(std::vector<BeamPoint> points);

  double inverseDistance_per_m() const { return w_[0]; }
  /// Derivatives of inverseDistance_per_m() by a, b and y of a point.
  Vec3 derivatives(size_t point) const;
  /// Sum of the squares of the weights of the points' y in w_0: variance of w_0 over that of a point.
  double leverage() const;
  /// Standard deviation of the points' y about the plane, 1/m.
  double scatter_per_m() const;

 private:
  Vec3 rowOf(const BeamPoint& point) const { return {1.0, point.across_1, point.across_2}; }
  double residualOf(const BeamPoint& point) const {
    return point.inverse_distance_per_m - w_.dot(rowOf(point));
  }
  std::vector<BeamPoint> points_;
  Mat3 inverse_;  ///< of the normal equations
  Vec3 w_;
};

}  // namespace lodeline
