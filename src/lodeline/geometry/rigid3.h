#pragma once

#include "lodeline/geometry/types.h"

namespace lodeline {

/// A rigid transformation. Named target_from_source: `world_from_body` maps body coordinates (m) into the
/// world.
struct Rigid3 {
  Quat rotation = Quat::Identity();  ///< target from source, unit
  Vec3 translation = Vec3::Zero();   ///< origin of the source frame in target coordinates, m

  Rigid3() = default;
  Rigid3(const Quat& rotation_in, const Vec3& translation_in)
      : rotation(rotation_in), translation(translation_in) {}

  /// From a 4x4 homogeneous matrix whose rotation part is orthonormal to 1e-3 or better (it is
  /// re-orthonormalized); throws InputError, naming `what`, otherwise.
  static Rigid3 fromMatrix(const Eigen::Matrix4d& matrix, const char* what);
  Eigen::Matrix4d matrix() const;

  Vec3 operator*(const Vec3& point) const { return rotation * point + translation; }
  Rigid3 operator*(const Rigid3& other) const {
    return Rigid3((rotation * other.rotation).normalized(), rotation * other.translation + translation);
  }
  Rigid3 inverse() const {
    const Quat inverse_rotation = rotation.conjugate();
    return Rigid3(inverse_rotation, -(inverse_rotation * translation));
  }
};

}  // namespace lodeline
