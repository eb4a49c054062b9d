#pragma once

#include "lodeline/types.h"

namespace lodeline {

/// Standard gravity (CGPM 1901), m/s^2.
constexpr double kStandardGravity = 9.80665;

/// Gravity g_W in the world frame (east, north, up), m/s^2. An accelerometer at rest reads R_B_W * (-g_W).
inline Vec3 standardGravity_W() { return Vec3(0.0, 0.0, -kStandardGravity); }

}  // namespace lodeline
