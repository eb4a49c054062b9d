#pragma once

#include <algorithm>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Values at even steps from second 0, with linear interpolation (rotations: spherical) between them; beyond
/// the ends, those of the ends.
template <class Value>
struct SampledTrack {
  double step_s = 0.1;
  std::vector<Value> values;

  Value at(double time_s) const {
    const double steps = std::clamp(time_s / step_s, 0.0, static_cast<double>(values.size() - 1));
    const size_t before = std::min(static_cast<size_t>(steps), values.size() - 1);
    const size_t after = std::min(before + 1, values.size() - 1);
    return between(values[before], values[after], steps - static_cast<double>(before));
  }

 private:
  static Vec3 between(const Vec3& a, const Vec3& b, double share) { return a + share * (b - a); }
  static Rigid3 between(const Rigid3& a, const Rigid3& b, double share) {
    return Rigid3(a.rotation.slerp(share, b.rotation), between(a.translation, b.translation, share));
  }
};

/// How far the water has been carried since second 0, m.
using DriftTrack = SampledTrack<Vec3>;
using PoseTrack = SampledTrack<Rigid3>;

}  // namespace lodeline
