#include "lodeline/problem/options/sonar_options.h"

#include "lodeline/util/settings/option_check.h"

namespace lodeline {

void SonarOptions::check() const {
  OptionCheck("sonar")
      .positive("noise_inflation", noise_inflation)
      .positive("surface_angle_rad", surface_angle_rad)
      .within("surface_angle_rad", surface_angle_rad, 0.0, 1.0)
      .atLeast("min_landmarks", min_landmarks, 4)
      .atLeast("max_landmarks", max_landmarks, min_landmarks)
      .positive("max_leverage", max_leverage)
      .notNegative("roughness", roughness)
      .positive("correlated_noise_time_s", correlated_noise_time_s)
      .positive("robust_scale_sigmas", robust_scale_sigmas)
      .positive("max_sigmas", max_sigmas)
      .positive("least_scale_sigma", least_scale_sigma)
      .atLeast("greatest_scale_sigma", greatest_scale_sigma, least_scale_sigma);
}

}  // namespace lodeline
