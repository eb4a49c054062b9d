#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/magnetometer/calibration/heading/field_alignment.h"
#include "lodeline/magnetometer/calibration/heading/inertial_residuals.h"
#include "lodeline/magnetometer/iron/magnetometer_fit.h"
#include "lodeline/rig.h"

namespace lodeline {

struct InertialCalibrationOptions {
  IronModel model = IronModel::Full;   ///< defines which entries of S are estimated
  double left_out_scale_sigma = 0.03;  ///< as in IronFitOptions
  double left_out_skew_sigma = 0.02;
  /// Readings within this interval share one orientation; the interval grows in long records.
  double least_moment_s = 0.02;
  int most_moments = 8000;
  int max_iterations = 15;
  /// Correlation time of the accelerations of a hand-held rig.
  double acceleration_correlation_s = 0.5;
  double accelerometer_bias_sigma_m_per_s2 = 0.1;
  /// A moment whose field residual exceeds this number of standard deviations is left out.
  double rejection_sigmas = 5.0;
  /// The time offset is used where it exceeds both thresholds; otherwise it is fixed at zero.
  double time_offset_sigmas = 4.0;
  double least_time_offset_s = 1e-3;
};

struct InertialCalibration {
  using Covariance = Eigen::Matrix<double, inertial_parameter::kSize, inertial_parameter::kSize>;

  InertialParameters parameters;
  Covariance covariance = Covariance::Zero();
  double reading_sigma = 0.0;           ///< of one reading and axis, in units of the field magnitude
  double gyroscope_noise_factor = 1.0;  ///< factor on the noise density of the IMU's calibration
  double residual = 0.0;                ///< RMS per axis of the used moments, same unit
  double rejected_share = 0.0;          ///< fraction of rejected moments
  double correlation_factor = 1.0;
  bool time_offset_significant = false;
  double measured_time_offset_s = 0.0;  ///< reported even where it is not significant and not used
  double time_offset_sigma_s = 0.0;
};

/// Maximum likelihood calibration of soft iron, hard iron and rotation to the IMU after Kok & Schön,
/// "Magnetometer calibration using inertial sensors", IEEE Sensors Journal 2016. The orientations are
/// estimated together with the parameters from gyroscope, accelerometer and magnetometer. The readings are
/// thus compared with the rotated field and not only with its magnitude. This implementation smooths the
/// orientations in batch (BorderedChain), whereas the paper filters. The standard deviations of magnetometer
/// and gyroscope noise maximize the likelihood with orientations and parameters integrated out (Laplace).
///
/// `field`: readings in units of the field magnitude, uncorrected, in order of time, without outliers.
/// `start`: soft and hard iron from the ellipsoid fit, rotation and time offset from alignField(). Throws
/// EstimationError where the iteration does not converge.
InertialCalibration calibrateWithInertialSensors(std::span<const NormalizedFieldSample> field,
                                                 std::span<const ImuSample> imu, const ImuNoise& noise,
                                                 const InertialParameters& start,
                                                 const InertialCalibrationOptions& options = {});

}  // namespace lodeline
