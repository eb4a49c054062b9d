#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lodeline/magnetometer/currents/current_fit.h"

namespace lodeline {

/// Test statistic of differences between fields of currents and calibrated ones: d^T (P + sigma^2 I)^-1 d,
/// summed over the three axes. `differences_T_per_A`: a row for each channel. `covariance`: P, of one
/// component of the rows, T^2/A^2. `sigma_T_per_A`: of each calibrated component.
struct CurrentContradiction {
  double chi_square = 0.0;
  int degrees_of_freedom = 0;
  /// Beyond what chance gives: six standard deviations above the mean of chi-square.
  bool isSignificant() const;
};
CurrentContradiction contradictionOf(const Eigen::MatrixXd& differences_T_per_A,
                                     const Eigen::MatrixXd& covariance, double sigma_T_per_A);

/// A calibration compared with a still test of another day.
struct CurrentCheck {
  std::vector<Vec3> differences_T_per_A;  ///< of each channel, test minus calibration
  CurrentResidual with;                   ///< residual of the test with the calibration
  CurrentContradiction contradiction;
  bool is_moved = false;  ///< the calibration must not be used
  std::string verdict;
};

/// Compares a calibration with a test and its fit. The channels of the calibration are found by name. Throws
/// InputError where the calibration has no fields, or lacks a channel of the test.
CurrentCheck checkCurrents(const CurrentFit& fit, const CurrentCalibration& calibration);

}  // namespace lodeline
