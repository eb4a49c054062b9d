#include "lodeline/problem/options/depth_options.h"

#include "lodeline/util/settings/option_check.h"

namespace lodeline {

void DepthGateOptions::check() const {
  OptionCheck("pressure.gate")
      .positive("max_sigmas", max_sigmas)
      .notNegative("max_jump_m", max_jump_m)
      .notNegative("readmission_s", readmission_s)
      .notNegative("least_slope", least_slope)
      .positive("greatest_slope", greatest_slope);
  OptionCheck("pressure.gate").atLeast("greatest_slope", greatest_slope, least_slope);
}

void DepthOptions::check() const {
  OptionCheck("pressure")
      .positive("density_ratio", density_ratio)
      .notNegative("density_ratio_sigma", density_ratio_sigma)
      .notNegative("least_density_sigma", least_density_sigma)
      .notNegative("lag_s", lag_s)
      .notNegative("lag_sigma_s", lag_sigma_s)
      .positive("offset_sigma_m", offset_sigma_m)
      .notNegative("offset_walk_m_per_sqrt_s", offset_walk_m_per_sqrt_s)
      .positive("noise_inflation", noise_inflation)
      .notNegative("floor_m", floor_m)
      .positive("correlated_noise_time_s", correlated_noise_time_s);
  gate.check();
}

}  // namespace lodeline
