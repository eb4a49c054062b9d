#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace lodeline {

/// Light transport uses single precision: at 250 m from the origin, a float resolves 0.03 mm.
using Vec3f = Eigen::Vector3f;
using Mat3f = Eigen::Matrix3f;

/// Smooth (C1) step from 0 at `from` to 1 at `to`; `from` may exceed `to`.
inline float smoothStep(float from, float to, float x) {
  const float t = std::min(1.0f, std::max(0.0f, (x - from) / (to - from)));
  return t * t * (3.0f - 2.0f * t);
}

inline float lerp(float a, float b, float t) { return a + t * (b - a); }

}  // namespace lodeline
