#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <compare>
#include <cstdint>

namespace lodeline {

/// A span of time with nanosecond resolution.
class Duration {
 public:
  constexpr Duration() = default;
  static constexpr Duration fromNanoseconds(int64_t ns) { return Duration(ns); }
  static Duration fromSeconds(double seconds) { return Duration(std::llround(seconds * 1e9)); }

  constexpr int64_t nanoseconds() const { return ns_; }
  constexpr double seconds() const { return static_cast<double>(ns_) * 1e-9; }

  constexpr auto operator<=>(const Duration&) const = default;
  constexpr Duration operator-() const { return Duration(-ns_); }
  constexpr Duration operator+(Duration other) const { return Duration(ns_ + other.ns_); }
  constexpr Duration operator-(Duration other) const { return Duration(ns_ - other.ns_); }

 private:
  explicit constexpr Duration(int64_t ns) : ns_(ns) {}
  int64_t ns_ = 0;
};

/// A point in time on the recording's clock: integer nanoseconds since the epoch of that clock. A double
/// would lose microseconds at current Unix times, so all interfaces use the integer.
class Time {
 public:
  constexpr Time() = default;
  static constexpr Time fromNanoseconds(int64_t ns) { return Time(ns); }
  static Time fromSeconds(double seconds) { return Time(std::llround(seconds * 1e9)); }

  constexpr int64_t nanoseconds() const { return ns_; }
  constexpr double seconds() const { return static_cast<double>(ns_) * 1e-9; }

  constexpr auto operator<=>(const Time&) const = default;
  constexpr Duration operator-(Time other) const { return Duration::fromNanoseconds(ns_ - other.ns_); }
  constexpr Time operator+(Duration d) const { return Time(ns_ + d.nanoseconds()); }
  constexpr Time operator-(Duration d) const { return Time(ns_ - d.nanoseconds()); }

 private:
  explicit constexpr Time(int64_t ns) : ns_(ns) {}
  int64_t ns_ = 0;
};

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat2 = Eigen::Matrix2d;
using Mat3 = Eigen::Matrix3d;
using Mat6 = Eigen::Matrix<double, 6, 6>;
using Mat23 = Eigen::Matrix<double, 2, 3>;
using Mat32 = Eigen::Matrix<double, 3, 2>;
/// Unit quaternion, Hamilton convention.
using Quat = Eigen::Quaterniond;

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

/// A place on or near the Earth, geodetic on the WGS84 ellipsoid.
struct GeodeticPosition {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height_m = 0.0;  ///< above the ellipsoid
};

}  // namespace lodeline
