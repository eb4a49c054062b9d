#pragma once

#include <string>

#include "lodeline/estimator/options/magnetometer_options.h"
#include "lodeline/estimator/state/window.h"
#include "lodeline/factors/prior_factor.h"

namespace lodeline {

/// Which way a window that has just started looks, from the field it measured.
struct HeadingAlignment {
  /// Start where the field says nothing of north; `refusal` then says why, in words.
  HeadingReference reference = HeadingReference::Start;
  std::string refusal;
  double yaw_rad = 0.0;         ///< by which the world is to be turned about its vertical
  Vec3 field_W = Vec3::Zero();  ///< T, in the turned world
};

/// `level_field_W`: mean of the start's fields, T, in a world whose vertical is right and whose yaw is not.
/// East is field x up, north up x east; true north further by the declination of the field at the site.
/// Refused where size or dip are not the Earth's, or not those of the site, and where the field is all but
/// vertical.
HeadingAlignment alignHeading(const Vec3& level_field_W, const MagnetometerOptions& options);

/// Turn about the vertical, rad in (-pi, pi], that takes a world in which the Earth's field is `field_W` to
/// one whose y axis points to `reference`, magnetic or true north.
double northFromWorld(const Vec3& field_W, HeadingReference reference, const MagnetometerOptions& options);

/// How well the azimuth of the Earth's field in the world is known, about the vertical.
struct AzimuthCovariance {
  double variance_rad2 = 0.0;
  /// With a state's [dp, dtheta, dv, db_g, db_a].
  Eigen::Matrix<double, 15, 1> with_state = Eigen::Matrix<double, 15, 1>::Zero();
};

/// `field`, `state_field`: covariances of the field's state (T^2), and of a state's errors with it.
AzimuthCovariance azimuthCovariance(const Vec3& field_W, const Mat3& field,
                                    const Eigen::Matrix<double, 15, 3>& state_field);

/// Makes a state's covariance, which is relative to the first pose's heading, relative to north: an azimuth
/// error d of the field turns the world about its origin, e' = e - u d with u = [z x p, z, z x v, 0, 0].
void relateToNorth(const NavigationState& state, const AzimuthCovariance& azimuth,
                   Eigen::Matrix<double, 15, 15>* covariance);

/// Turns the world under a window of which nothing has been marginalized yet, and under the prior on its
/// first frame (startPrior), whose heading is then known to `yaw_sigma_rad` only.
void turnWorld(double yaw_rad, double yaw_sigma_rad, Window* window, Prior* prior);

}  // namespace lodeline
