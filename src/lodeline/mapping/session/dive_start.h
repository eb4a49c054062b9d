#pragma once

#include "lodeline/types.h"

namespace lodeline {

/// Where a dive began, as stated: east, north, up relative to the origin of the map, m.
struct DiveStart {
  Vec3 position = Vec3::Zero();
  double horizontal_sigma_m = 3.0;  ///< per axis, as of a GPS fix of the entrance
  double vertical_sigma_m = 1.0;

  /// Throws UsageError for numbers that are not finite, or sigmas that are not positive.
  void check() const;
};

}  // namespace lodeline
