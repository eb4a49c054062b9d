#pragma once

namespace lodeline {

/// Covariance inflation of one interval of inertial readings that images contradict: white noise densities,
/// and steps of the biases, one sigma per axis.
struct InertialDoubt {
  double gyroscope_density_rad_per_s_sqrtHz = 0.0;
  double accelerometer_density_m_per_s2_sqrtHz = 0.0;
  double gyroscope_bias_step_rad_per_s = 0.0;
  double accelerometer_bias_step_m_per_s2 = 0.0;

  bool any() const {
    return gyroscope_density_rad_per_s_sqrtHz > 0.0 || accelerometer_density_m_per_s2_sqrtHz > 0.0 ||
           gyroscope_bias_step_rad_per_s > 0.0 || accelerometer_bias_step_m_per_s2 > 0.0;
  }
};

}  // namespace lodeline
