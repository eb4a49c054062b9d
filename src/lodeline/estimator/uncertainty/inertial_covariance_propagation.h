#pragma once

#include <Eigen/Core>
#include <optional>

#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Propagates the covariance of the newest state by inertial readings alone, so that the reported covariance
/// keeps growing without images.
///
/// After minutes without images, a position that is known to 100 m depends on neighbours that are known
/// relative to each other to micrometres. The window's covariance is then the small difference of
/// informations that are larger by 1e14. That exhausts the digits of a double, and the information left comes
/// out too large. For horizontal position and velocity, which only images determine, the reported variance is
/// therefore at least the propagated one. The same holds for heading without a magnetometer. Where the window
/// gives no covariance (isCovariance()), the propagated one replaces it. A sensor that measures velocity
/// (Measurement::measuresVelocity) bounds the propagated covariance; what is unknown of its calibration is
/// part of the window's alone.
class InertialCovariancePropagation {
 public:
  /// `claimed`: the window's covariance of the newest frame's [dp, dtheta, dv, db_g, db_a]. It is enlarged
  /// where `is_blind`. `is_heading_told`: a magnetometer determines the heading.
  void follow(Window& window, const FactorBuilder& factors, bool is_blind, bool is_heading_told,
              Eigen::Matrix<double, 15, 15>* claimed);

 private:
  std::optional<Eigen::Matrix<double, 15, 15>> carried_;
};

}  // namespace lodeline
