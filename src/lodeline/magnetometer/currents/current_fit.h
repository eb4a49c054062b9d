#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/magnetometer/currents/robust_lines.h"
#include "lodeline/magnetometer/currents/still_record.h"

namespace lodeline {

/// Field of one channel, as a still test tells it.
struct CurrentChannel {
  std::string name;
  Vec3 field_T_per_A = Vec3::Zero();  ///< k_i, axes of the raw readings
  double sigma_T_per_A = 0.0;         ///< one sigma of each component
  double largest_A = 0.0;             ///< largest absolute current of the test
  /// Why the test does not tell this channel from the others or from nothing; empty where it does.
  std::string objection;

  /// Size of the field at the largest current of the test, T.
  double largestField_T() const { return field_T_per_A.norm() * largest_A; }
  bool isIdentified() const { return objection.empty(); }
};

/// Differences of the readings from a slow baseline during a test.
struct CurrentResidual {
  double rms_T = 0.0;  ///< root mean square size of the vector
  double heading_rms_rad = 0.0;
  double heading_largest_rad = 0.0;
};

/// What a still test tells of the fields of currents.
struct CurrentFit {
  std::vector<CurrentChannel> channels;
  /// Covariance of one component of all k_i, T^2/A^2; zero for channels that never changed.
  Eigen::MatrixXd covariance;
  /// One sigma of each component of each k_i for CurrentCalibration: that of the sum at the test's currents,
  /// and two per cent of the fields for non-linearity and change from day to day.
  double field_sigma_T_per_A = 0.0;
  double rate_hz = 0.0;  ///< of the current readings
  double lag_s =
      0.0;  ///< the currents' stamps are early by this against the magnetometer's; 0 if not significant
  double measured_lag_s = 0.0, lag_sigma_s = 0.0;
  CurrentResidual without, with;    ///< residuals without and with the currents' fields
  double correlated_rms_rad = 0.0;  ///< heading of the residual's means over a second, with the fields
  double turned_rad = 0.0;       ///< largest rotation during the test by the gyroscope, beside a slow drift
  bool is_motion_known = false;  ///< there are gyroscope readings
  int readings = 0;              ///< that were used
  double rejected_share = 0.0;   ///< of the readings, by their residuals
  std::string heading_source;    ///< "accelerometer", or "assumed" for a dip of 60 degrees
  std::string verdict;

  /// The table of the test, the least squares on it, and the currents of its rows, A.
  TestTable table;
  RobustLines lines;
  Eigen::MatrixXd currents_A;

  bool isComplete() const;
  /// k_i, T/A, a row for each channel.
  Eigen::MatrixXd fields_T_per_A() const;
};

/// Estimates the fields of currents from a still test by robust least squares (Cauchy weights):
///
///   reading(t) = baseline(t) + G phi(t) + sum_i k_i I_i(t - lag) + noise
///
/// The baseline is linear between knots a minute apart: hard iron, the Earth's field and drift. phi is the
/// small rotation by the gyroscope, with a free 3x3 matrix G, and takes part only where the vehicle moved.
/// The lag minimizes the robust cost. The covariance contains the correlation of the residuals in time.
/// Throws EstimationError, with the remedy, where the test is too short, the vehicle turned by more than a
/// few degrees, or no channel is identified.
CurrentFit fitCurrents(const StillTest& test, Diagnostics* diagnostics);

}  // namespace lodeline
