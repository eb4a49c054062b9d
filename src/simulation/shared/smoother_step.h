#pragma once

#include <algorithm>

namespace lodeline {

/// Smooth (C2) step from 0 at u = 0 to 1 at u = 1.
inline double smootherStep01(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * (10.0 + u * (6.0 * u - 15.0));
}

}  // namespace lodeline
