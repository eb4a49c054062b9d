#pragma once

namespace lodeline {

/// Limits of the gate on depth readings.
struct DepthGateOptions {
  /// A jump is rejected if it exceeds both limits.
  double max_sigmas = 4.0;
  double max_jump_m = 0.15;
  /// After a rejection of this length, steady readings are used with a new offset.
  double readmission_s = 10.0;
  /// Readings that change outside these multiples of the estimated rise have another unit, or measure no
  /// water pressure.
  double least_slope = 0.6;
  double greatest_slope = 1.4;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

/// Options of the fusion of depth readings. The model of the gauge is that of factors/sensors/depth_factor.h.
struct DepthOptions {
  bool use = true;
  /// Density of the water over the density that the gauge assumes, and its sigma. Gauges are set to 1000,
  /// 1020 or 1030 kg/m^3; water has 997 to 1030.
  double density_ratio = 1.0;
  double density_ratio_sigma = 0.02;
  /// Whether the distribution of typical waters and gauges (water_density_prior.h) informs the ratio where
  /// the user did not state it.
  bool water_density_prior = true;
  /// Lower limit of the density ratio's reported sigma. Images determine the density from the direction in
  /// which they see the rig move. Errors of the intrinsics bias that direction by one or two tenths of a
  /// degree for minutes, and no covariance contains this error. In a passage that descends by one metre in
  /// seven it corresponds to this sigma.
  double least_density_sigma = 0.007;
  double lag_s = 0.3;
  double lag_sigma_s = 0.4;
  /// Sigma of the depth at the world's origin before the first reading.
  double offset_sigma_m = 1000.0;
  double offset_walk_m_per_sqrt_s = 2e-4;  ///< the air pressure and the water level change
  double noise_inflation = 1.0;            ///< factor on depth_noise_std of the sensor's file
  /// Time-correlated errors: resolution, pressure of the flow, residual error of the lag's model. One sigma,
  /// and the correlation time.
  double floor_m = 0.01;
  double correlated_noise_time_s = 5.0;
  DepthGateOptions gate;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

}  // namespace lodeline
