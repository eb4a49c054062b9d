#pragma once

#include "lodeline/types.h"

namespace lodeline {

/// Functions on the rotation group SO(3) with rotation vectors (rad) as coordinates. Formulas: J. Solà,
/// "Quaternion kinematics for the error-state Kalman filter", 2017, sections 2 and 4.3. Every function is
/// exact to machine precision at small angles.
namespace so3 {

/// Cross-product matrix [v]x, so that skew(v) * w = v x w.
Mat3 skew(const Vec3& v);

/// Unit quaternion of a rotation vector (exponential map).
Quat exp(const Vec3& rotation_vector);

/// Rotation vector of a unit quaternion (logarithmic map), its norm in [0, pi].
Vec3 log(const Quat& rotation);

/// Right Jacobian J_r: exp(v + dv) = exp(v) * exp(J_r(v) dv) to first order.
Mat3 rightJacobian(const Vec3& rotation_vector);

/// Inverse of the right Jacobian: log(exp(v) * exp(d)) = v + J_r^-1(v) d to first order.
Mat3 rightJacobianInverse(const Vec3& rotation_vector);

/// Left Jacobian J_l(v) = J_r(-v).
Mat3 leftJacobian(const Vec3& rotation_vector);

/// The same rotation as a quaternion of unit length with w >= 0.
Quat canonical(const Quat& rotation);

}  // namespace so3

/// Orthonormal basis (3x2) of the plane normal to a unit direction. It is a continuous function of the
/// direction within each half space of z.
Mat32 tangentBasis(const Vec3& direction);

}  // namespace lodeline
