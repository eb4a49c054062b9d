#pragma once

#include "lodeline/geometry/so3.h"

namespace lodeline {

/// Rotation over a stretch of time in which the body's rate (rad/s, body axes) runs linearly from `from` to
/// `to`: exp(rotation_vector) = body then from body at its end. First two terms of the Magnus expansion
/// (Blanes et al., "The Magnus expansion and some of its applications", Physics Reports 2009, section 2).
struct RotationIncrement {
  Vec3 rotation_vector;  ///< rad
  Mat3 by_bias;          ///< derivative by a bias taken off both rates, s

  RotationIncrement(const Vec3& from, const Vec3& to, double stretch_s)
      : rotation_vector(0.5 * stretch_s * (from + to) + stretch_s * stretch_s / 12.0 * from.cross(to)),
        by_bias(-stretch_s * Mat3::Identity() + stretch_s * stretch_s / 12.0 * so3::skew(to - from)) {}
};

}  // namespace lodeline
