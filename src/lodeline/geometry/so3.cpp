#include "lodeline/geometry/so3.h"

#include <cmath>

namespace lodeline {
namespace so3 {
namespace {

// Below this squared angle (rad^2) the series is used; its first neglected term is under 1e-16.
constexpr double kSmallAngleSquared = 1e-6;

}  // namespace

Mat3 skew(const Vec3& v) {
  Mat3 m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Quat exp(const Vec3& rotation_vector) {
  const double angle_squared = rotation_vector.squaredNorm();
  double w;
  double scale;  // sin(angle / 2) / angle
  if (angle_squared < kSmallAngleSquared) {
    w = 1.0 - angle_squared / 8.0 + angle_squared * angle_squared / 384.0;
    scale = 0.5 - angle_squared / 48.0 + angle_squared * angle_squared / 3840.0;
  } else {
    const double angle = std::sqrt(angle_squared);
    w = std::cos(0.5 * angle);
    scale = std::sin(0.5 * angle) / angle;
  }
  const Vec3 xyz = scale * rotation_vector;
  return Quat(w, xyz.x(), xyz.y(), xyz.z()).normalized();
}

Vec3 log(const Quat& rotation) {
  const Quat q = rotation.w() < 0.0 ? Quat(-rotation.coeffs()) : rotation;
  const double sine = q.vec().norm();
  if (sine < 1e-3) {
    // angle / sine = 2 asin(s) / s, expanded in s.
    return (2.0 + sine * sine / 3.0 + 3.0 * sine * sine * sine * sine / 20.0) * q.vec();
  }
  return 2.0 * std::atan2(sine, q.w()) / sine * q.vec();
}

Mat3 rightJacobian(const Vec3& rotation_vector) {
  const double angle_squared = rotation_vector.squaredNorm();
  const Mat3 k = skew(rotation_vector);
  double a;  // (1 - cos) / angle^2
  double b;  // (angle - sin) / angle^3
  if (angle_squared < kSmallAngleSquared) {
    a = 0.5 - angle_squared / 24.0;
    b = 1.0 / 6.0 - angle_squared / 120.0;
  } else {
    const double angle = std::sqrt(angle_squared);
    a = (1.0 - std::cos(angle)) / angle_squared;
    b = (angle - std::sin(angle)) / (angle_squared * angle);
  }
  return Mat3::Identity() - a * k + b * k * k;
}

Mat3 rightJacobianInverse(const Vec3& rotation_vector) {
  const double angle_squared = rotation_vector.squaredNorm();
  const Mat3 k = skew(rotation_vector);
  double c;  // 1 / angle^2 - (1 + cos) / (2 angle sin)
  if (angle_squared < kSmallAngleSquared) {
    c = 1.0 / 12.0 + angle_squared / 720.0;
  } else {
    const double angle = std::sqrt(angle_squared);
    // The half-angle form stays finite at angle = pi.
    c = 1.0 / angle_squared - std::cos(0.5 * angle) / (2.0 * angle * std::sin(0.5 * angle));
  }
  return Mat3::Identity() + 0.5 * k + c * k * k;
}

Mat3 leftJacobian(const Vec3& rotation_vector) { return rightJacobian(-rotation_vector); }

Quat canonical(const Quat& rotation) {
  Quat q = rotation.normalized();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  return q;
}

}  // namespace so3

Mat32 tangentBasis(const Vec3& direction) {
  // Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
  const double sign = std::copysign(1.0, direction.z());
  const double a = -1.0 / (sign + direction.z());
  const double b = direction.x() * direction.y() * a;
  Mat32 basis;
  basis.col(0) << 1.0 + sign * direction.x() * direction.x() * a, sign * b, -sign * direction.x();
  basis.col(1) << b, sign + direction.y() * direction.y() * a, -direction.y();
  return basis;
}

}  // namespace lodeline
