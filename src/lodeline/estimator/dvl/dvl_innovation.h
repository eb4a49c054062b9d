#pragma once

#include <optional>
#include <vector>

#include "lodeline/estimator/dvl/dvl_measurement.h"
#include "lodeline/problem/covariance.h"

namespace lodeline {

/// Predicted minus measured velocities of a ping's rows, with their joint covariance.
struct DvlInnovation {
  Eigen::VectorXd value_m_per_s;
  Eigen::VectorXd measured_m_per_s;
  Eigen::MatrixXd covariance;  ///< (m/s)^2; empty where the covariance of the window is not known

  /// Whether some of the rows agree with the prediction: their Mahalanobis distance is below the quantile of
  /// the chi-square distribution that a normal variable exceeds beyond `max_sigmas` on one side.
  bool agrees(const std::vector<int>& rows, double max_sigmas) const;
  /// Whether the same velocities with the opposite sign would have disagreed.
  bool isTest(double max_sigmas) const;
};

/// The innovation of a ping at the newest frame of a window. `known`: covariance of the window when the frame
/// before was the newest; it is carried on by the inertial readings since then. A velocity through the water
/// needs the current as a state of the window, which `known` may lack when it is new. `speed_sigma`: relative
/// sigma of the predicted speed beside it.
DvlInnovation innovate(const DvlPing& ping, const Window& window, const JointCovariance& known,
                       double speed_sigma);

/// Approximate quantile of the chi-square distribution with `dof` degrees of freedom, for the probability
/// with which a normal variable stays below `sigmas` (E. B. Wilson, M. M. Hilferty, "The distribution of
/// chi-square", PNAS 17, 1931).
double chiSquareQuantile(int dof, double sigmas);

}  // namespace lodeline
