#pragma once

#include <string>

#include "lodeline/factors/prior_factor.h"
#include "lodeline/problem/options/magnetometer_options.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Heading of a window that has just started, from its measured field.
struct HeadingAlignment {
  /// Start where the field does not give a direction of north; `refusal` is then the reason in words.
  HeadingReference reference = HeadingReference::Start;
  std::string refusal;
  double yaw_rad = 0.0;         ///< rotation of the world about its vertical
  Vec3 field_W = Vec3::Zero();  ///< T, in the rotated world
};

/// The reference that the options ask for, with `Automatic` decided.
HeadingReference wantedReference(const MagnetometerOptions& options);

/// Computes the yaw that turns a level world to north. `level_field_W`: mean of the fields at the start, T,
/// in a world with a correct vertical and an arbitrary yaw. East is field x up, north is up x east; true
/// north differs from this by the declination of the field at the site. A nearly vertical field, and a size
/// or dip unlike the Earth's or the site's, are refused.
HeadingAlignment alignHeading(const Vec3& level_field_W, const MagnetometerOptions& options);

/// Rotation about the vertical, rad in (-pi, pi], from a world in which the Earth's field is `field_W` to one
/// whose y axis points north. `reference`: magnetic or true north.
double northFromWorld(const Vec3& field_W, HeadingReference reference, const MagnetometerOptions& options);

/// Variance of the azimuth of the Earth's field in the world, and its covariance with a state.
struct AzimuthCovariance {
  double variance_rad2 = 0.0;
  /// Covariance with a state's [dp, dtheta, dv, db_g, db_a].
  Eigen::Matrix<double, 15, 1> with_state = Eigen::Matrix<double, 15, 1>::Zero();
};

/// `field`: covariance of the field's state (T^2); `state_field`: cross-covariance of a state's errors with
/// it.
AzimuthCovariance azimuthCovariance(const Vec3& field_W, const Mat3& field,
                                    const Eigen::Matrix<double, 15, 3>& state_field);

/// Converts a state's covariance from relative to the first pose's heading to relative to north. An azimuth
/// error d of the field rotates the world about its origin: e' = e - u d with u = [z x p, z, z x v, 0, 0].
void relateToNorth(const NavigationState& state, const AzimuthCovariance& azimuth,
                   Eigen::Matrix<double, 15, 15>* covariance);

/// Rotates the world of a window without marginalized states, together with the prior on its first frame
/// (startPrior).
void turnWorld(double yaw_rad, Window* window, Prior* prior);

}  // namespace lodeline
