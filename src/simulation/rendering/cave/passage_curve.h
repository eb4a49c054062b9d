#pragma once

#include <functional>

#include "simulation/rendering/cave/centerline.h"

namespace lodeline {

/// A place on the middle line of a passage and the size of the cross-section there.
struct PassagePoint {
  Vec3 position_W = Vec3::Zero();  ///< m
  double width_m = 0.0;
  double height_m = 0.0;
};

/// A smooth middle line as a function of any parameter that advances along it.
using PassageCurve = std::function<PassagePoint(double)>;

/// A smooth curve from `begin` to `end` as a centreline whose arc lengths start at `first_arc_length_m`. The
/// spacing of the stations is the one next to `spacing_m` that divides the length. The two ends of a closed
/// curve must be the same place.
Centerline evenlySpaced(const PassageCurve& curve, double begin, double end, double first_arc_length_m,
                        bool closed, double spacing_m = 0.25);

/// 0 up to `u` = 0, 1 from `u` = 1 on, with continuous curvature.
double smoothRise(double u);

}  // namespace lodeline
