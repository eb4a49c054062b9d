#pragma once

#include <optional>
#include <span>

#include "lodeline/types.h"

namespace lodeline {

/// The surface |matrix (y - centre)| = 1.
struct Ellipsoid {
  Vec3 centre = Vec3::Zero();      ///< unit of the points
  Mat3 matrix = Mat3::Identity();  ///< symmetric, positive definite, 1 / unit of the points

  /// Lengths of the semi-axes, longest first, unit of the points.
  Vec3 semiAxes() const;
};

/// Fits an ellipsoid by least squares in the algebraic distance, under a constraint that admits only
/// ellipsoids: Li & Griffiths, "Least squares ellipsoid specific fitting", GMP 2004, with k = 4. The result
/// is invariant to translation and rotation of the points. Returns nothing for fewer than 9 points or points
/// on a plane or line.
std::optional<Ellipsoid> fitEllipsoid(std::span<const Vec3> points);

/// Fits a sphere by linear least squares in |y - centre|^2 - radius^2. Returns nothing for fewer than four
/// points or points on a plane.
std::optional<Ellipsoid> fitSphere(std::span<const Vec3> points);

}  // namespace lodeline
