#pragma once

#include <optional>
#include <span>

#include "lodeline/geometry/types.h"

namespace lodeline {

/// The surface |matrix (y - centre)| = 1.
struct Ellipsoid {
  Vec3 centre = Vec3::Zero();      ///< unit of the points
  Mat3 matrix = Mat3::Identity();  ///< symmetric, positive definite, 1 / unit of the points

  /// Longest first, unit of the points.
  Vec3 semiAxes() const;
};

/// Least squares in the algebraic distance under a constraint that admits ellipsoids only: Li & Griffiths,
/// "Least squares ellipsoid specific fitting", GMP 2004, with k = 4. The result does not depend on where the
/// points lie or how they are turned. Nothing where there are fewer than 9 points or they lie on a plane, or
/// a line.
std::optional<Ellipsoid> fitEllipsoid(std::span<const Vec3> points);

/// Least squares in |y - centre|^2 - radius^2, which is linear. Nothing where there are fewer than four
/// points or they lie on a plane.
std::optional<Ellipsoid> fitSphere(std::span<const Vec3> points);

}  // namespace lodeline
