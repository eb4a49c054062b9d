#pragma once

#include <Eigen/Core>
#include <optional>

#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

/// Keeps what is claimed in the dark from ceasing to grow.
///
/// After minutes without images a position that is known to 100 m hangs on neighbours that know each other to
/// micrometres. What the window knows of it is what is left when informations are subtracted that are larger
/// by 1e14, as many digits as a number has, and comes out too large. So the covariance is carried along by
/// itself as well, by inertial readings alone, and of horizontal position and velocity, which nothing but
/// images tells, no less is claimed; nor of heading without a magnetometer. Where the window gives no
/// covariance (isCovariance()), the one carried along stands for it.
class InertialCovariancePropagation {
 public:
  /// `claimed`: by the window, of the newest frame's [dp, dtheta, dv, db_g, db_a]; widened where it
  /// `is_blind`.
  void follow(Window& window, const FactorBuilder& factors, bool is_blind, bool is_heading_told,
              Eigen::Matrix<double, 15, 15>* claimed);

 private:
  std::optional<Eigen::Matrix<double, 15, 15>> carried_;
};

}  // namespace lodeline
