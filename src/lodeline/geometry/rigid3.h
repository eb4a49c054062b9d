#pragma once

#include "lodeline/geometry/types.h"

namespace lodeline {

/// Rigid transformation target_from_source, x_target = R x_source + t. For example, `world_from_body` maps
/// body coordinates (m) to world coordinates.
struct Rigid3 {
  Quat rotation = Quat::Identity();  ///< R, target from source, unit quaternion
  Vec3 translation = Vec3::Zero();   ///< t, origin of the source frame in target coordinates, m

  Rigid3() = default;
  Rigid3(const Quat& rotation_in, const Vec3& translation_in)
      : rotation(rotation_in), translation(translation_in) {}

  /// Transformation from a 4x4 homogeneous matrix. The rotation part must be orthonormal to 1e-3 and is
  /// re-orthonormalized. Throws InputError naming `what` otherwise.
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
