#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/magnetometer/calibration/heading/field_alignment.h"
#include "lodeline/magnetometer/calibration/heading/inertial_residuals.h"
#include "lodeline/magnetometer/iron/magnetometer_fit.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

struct InertialCalibrationOptions {
  IronModel model = IronModel::Full;   ///< which part of S is estimated
  double left_out_scale_sigma = 0.03;  ///< as in IronFitOptions
  double left_out_skew_sigma = 0.02;
  /// Readings closer together than this share one orientation; so do more of them in long records.
  double least_moment_s = 0.02;
  int most_moments = 8000;
  int max_iterations = 15;
  /// Accelerations of a rig that is waved about stay alike for so long.
  double acceleration_correlation_s = 0.5;
  double accelerometer_bias_sigma_m_per_s2 = 0.1;
  /// A moment whose field lies further off, in standard deviations of the residual, is left out.
  double rejection_sigmas = 5.0;
  /// The time offset counts where it is beyond both; otherwise it is held at zero.
  double time_offset_sigmas = 4.0;
  double least_time_offset_s = 1e-3;
};

struct InertialCalibration {
  using Covariance = Eigen::Matrix<double, inertial_parameter::kSize, inertial_parameter::kSize>;

  InertialParameters parameters;
  Covariance covariance = Covariance::Zero();
  double reading_sigma = 0.0;           ///< of one reading and axis, in units of the field's size
  double gyroscope_noise_factor = 1.0;  ///< on the density of the IMU's calibration
  double residual = 0.0;                ///< RMS per axis of the moments used, same unit
  double rejected_share = 0.0;          ///< of the moments
  double correlation_factor = 1.0;
  bool time_offset_significant = false;
  double measured_time_offset_s = 0.0;  ///< also where it is not significant and not used
  double time_offset_sigma_s = 0.0;
};

/// Maximum likelihood calibration of soft iron, hard iron and rotation to the IMU after Kok & Schön,
/// "Magnetometer calibration using inertial sensors", IEEE Sensors Journal 2016: orientation is estimated
/// together with the parameters from gyroscope, accelerometer and magnetometer, so that the readings are
/// compared with the turned field and not only with its size. Here the orientations are smoothed in batch
/// (BorderedChain) where the paper filters, and the standard deviations of magnetometer and gyroscope noise
/// are those that maximize the likelihood with orientations and parameters integrated out (Laplace).
///
/// `field`: readings in units of the field's size, uncorrected, in order of time, without outliers. `start`:
/// soft and hard iron from the fit of the ellipsoid, rotation and time offset from alignField(). Throws
/// EstimationError where the iteration does not settle.
InertialCalibration calibrateWithInertialSensors(std::span<const NormalizedFieldSample> field,
                                                 std::span<const ImuSample> imu, const ImuNoise& noise,
                                                 const InertialParameters& start,
                                                 const InertialCalibrationOptions& options = {});

}  // namespace lodeline
