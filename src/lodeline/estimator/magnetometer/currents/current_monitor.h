#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>

#include "lodeline/magnetometer/currents/current_check.h"
#include "lodeline/types.h"

namespace lodeline {

/// Compares the calibrated fields of currents with a dive. It regresses changes of the compensated field
/// over a second on changes of the currents. Heading, iron far away and drift hardly change within a second,
/// while thrusters do. A calibration holds as long as the regression's coefficients agree with zero within
/// their covariance and the calibration's sigma (contradictionOf).
///
/// The sums fade with five minutes. Changes beyond the usual residual have Cauchy's weight, so that passing
/// iron counts little. The variance is that of the residuals.
class CurrentMonitor {
 public:
  /// `sigma_T_per_A`: of each component of the calibrated fields.
  CurrentMonitor(size_t channels, double sigma_T_per_A);

  /// Adds a frame's mean currents, and its field minus the expected and the calibrated ones (T, body axes,
  /// white noise of `white_variance_T2` per axis).
  void add(Time time, const Eigen::VectorXd& currents_A, const Vec3& difference_B, double white_variance_T2);

  /// Whether the calibration is wrong, and by so much that it harms.
  bool isContradicted() const;
  /// Root mean square field, T, that the calibration leaves of the changes of the currents.
  double leftField_T() const;
  /// Fields of the dive minus the calibrated ones, T/A, a row for each channel, body axes.
  Eigen::MatrixXd differences_T_per_A() const;

 private:
  struct Sample {
    Time time;
    Eigen::VectorXd currents_A;
    Vec3 difference_B = Vec3::Zero();
  };
  /// Of a change per axis: that of the residuals, and at least the white noise.
  double variance_T2() const { return std::max(residual_square_T2_, white_square_T2_) / residual_weight_; }
  /// Inverse of the information, which times the variance is the covariance of one component.
  Eigen::MatrixXd inverse() const;

  double sigma_T_per_A_;
  std::optional<Sample> last_;
  Eigen::MatrixXd information_A2_;   ///< faded sum of changes times changes
  Eigen::MatrixXd right_side_A_T_;   ///< faded sum of changes times fields
  double residual_square_T2_ = 0.0;  ///< faded sum, per axis
  double white_square_T2_ = 0.0;     ///< the same of the white noise of changes
  double residual_weight_ = 0.0;     ///< faded number of changes with known coefficients
};

}  // namespace lodeline
