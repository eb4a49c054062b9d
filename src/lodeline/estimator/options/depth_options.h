#pragma once

namespace lodeline {

/// When a depth reading is believed.
struct DepthGateOptions {
  /// A jump beyond both limits is rejected.
  double max_sigmas = 4.0;
  double max_jump_m = 0.15;
  /// After so long a rejection, steady readings count from a new offset.
  double readmission_s = 10.0;
  /// Readings that follow less or more than these multiples of the estimated rise and fall are in another
  /// unit, or do not come from the water at all.
  double least_slope = 0.6;
  double greatest_slope = 1.4;
};

/// How depth readings are fused. The gauge's model is that of factors/depth_factor.h.
struct DepthOptions {
  bool use = true;
  /// Density of the water over that which the gauge assumes, and how far that may be off: gauges are set to
  /// 1000, 1020 or 1030 kg/m^3, water has 997 to 1030.
  double density_ratio = 1.0;
  double density_ratio_sigma = 0.02;
  /// Whether waters and gauges as they mostly are (water_density_prior.h) say more than that, to who was not
  /// told.
  bool water_density_prior = true;
  /// Images learn the density from the direction in which they see the rig move. A lens that is not as its
  /// file says puts that off by one or two tenths of a degree for minutes, which no covariance knows: in a
  /// passage that descends by one metre in seven it is worth so much. Heights are claimed no better than
  /// that.
  double least_density_sigma = 0.007;
  double lag_s = 0.3;
  double lag_sigma_s = 0.4;
  /// Of the depth read at the start, before the first reading.
  double offset_sigma_m = 1000.0;
  double offset_walk_m_per_sqrt_s = 2e-4;  ///< the air's pressure and the water's level change
  double noise_inflation = 1.0;            ///< factor on depth_noise_std of the sensor's file
  /// Errors that last: resolution, the flow's own pressure, what the lag's model leaves. One sigma, and how
  /// long they stay the same.
  double floor_m = 0.01;
  double correlated_noise_time_s = 5.0;
  DepthGateOptions gate;
};

}  // namespace lodeline
