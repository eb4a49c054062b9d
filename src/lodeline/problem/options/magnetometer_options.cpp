#include "lodeline/problem/options/magnetometer_options.h"

#include "lodeline/util/settings/option_check.h"

namespace lodeline {

void MagnetometerGateOptions::check() const {
  OptionCheck("magnetometer.gate")
      .notNegative("max_norm_error", max_norm_error)
      .notNegative("max_dip_error_rad", max_dip_error_rad)
      .positive("max_sigmas", max_sigmas)
      .positive("field_sigma_T", field_sigma_T)
      .within("release_share", release_share, 0.0, 1.0)
      .notNegative("release_s", release_s)
      .notNegative("readmission_s", readmission_s)
      .positive("memory_s", memory_s)
      .positive("rejection_window_s", rejection_window_s)
      .notNegative("max_rejected_ratio", max_rejected_ratio)
      .notNegative("rejection_margin_s", rejection_margin_s)
      .notNegative("max_correlated_sigma_rad", max_correlated_sigma_rad)
      .notNegative("retry_after_s", retry_after_s);
}

void MagneticStepDetectorOptions::check() const {
  OptionCheck("magnetometer.step")
      .positive("segment_s", segment_s)
      .notNegative("min_step_T", min_step_T)
      .positive("max_step_T", max_step_T)
      .notNegative("min_white_sigmas", min_white_sigmas)
      .notNegative("min_usual_sizes", min_usual_sizes)
      .positive("memory_s", memory_s)
      .notNegative("max_slope", max_slope)
      .within("min_besides_heading", min_besides_heading, 0.0, 1.0)
      .notNegative("settling_s", settling_s)
      .notNegative("relative_sigma", relative_sigma)
      .within("returned_share", returned_share, 0.0, 1.0)
      .notNegative("return_s", return_s);
}

void MagnetometerOptions::check() const {
  OptionCheck("magnetometer")
      .notNegative("correlated_noise_sigma_T", correlated_noise_sigma_T)
      .positive("correlated_noise_time_s", correlated_noise_time_s)
      .positive("correlated_noise_memory_s", correlated_noise_memory_s)
      .positive("student_dof", student_dof)
      .positive("deviation_s", deviation_s)
      .positive("noise_inflation", noise_inflation)
      .positive("field_sigma_T", field_sigma_T)
      .notNegative("offset_sigma_T", offset_sigma_T)
      .notNegative("unstated_offset_sigma_T", unstated_offset_sigma_T)
      .notNegative("uncalibrated_offset_sigma_T", uncalibrated_offset_sigma_T)
      .notNegative("uncalibrated_axes_sigma", uncalibrated_axes_sigma)
      .notNegative("offset_walk_T_per_sqrt_s", offset_walk_T_per_sqrt_s)
      .notNegative("disturbance_sigma_T", disturbance_sigma_T)
      .notNegative("disturbance_walk_T_per_sqrt_s", disturbance_walk_T_per_sqrt_s)
      .notNegative("max_start_norm_error", max_start_norm_error)
      .notNegative("max_start_dip_error_rad", max_start_dip_error_rad)
      .notNegative("min_horizontal_field_T", min_horizontal_field_T)
      .notNegative("declination_sigma_rad", declination_sigma_rad);
  gate.check();
  step.check();
}

}  // namespace lodeline
