#include "lodeline/estimator/options/sonar_options.h"

#include <fmt/core.h>

#include <cmath>

#include "lodeline/diagnostics.h"

namespace lodeline {

void SonarOptions::check() const {
  const auto require = [](bool is_right, const char* name, double value, const char* range) {
    if (!is_right) throw UsageError(fmt::format("sonar.{} must be {}, got {:g}", name, range, value));
  };
  const auto requirePositive = [&](const char* name, double value) {
    require(std::isfinite(value) && value > 0.0, name, value, "positive");
  };
  requirePositive("noise_inflation", noise_inflation);
  require(surface_angle_rad > 0.0 && surface_angle_rad < 1.0, "surface_angle_rad", surface_angle_rad,
          "between 0 and 1");
  require(min_landmarks >= 4, "min_landmarks", min_landmarks, "at least 4");
  require(max_landmarks >= min_landmarks, "max_landmarks", max_landmarks, "at least min_landmarks");
  requirePositive("max_leverage", max_leverage);
  require(std::isfinite(roughness) && roughness >= 0.0, "roughness", roughness, "at least 0");
  requirePositive("correlated_noise_time_s", correlated_noise_time_s);
  requirePositive("robust_scale_sigmas", robust_scale_sigmas);
  requirePositive("max_sigmas", max_sigmas);
  requirePositive("least_scale_sigma", least_scale_sigma);
  require(greatest_scale_sigma >= least_scale_sigma, "greatest_scale_sigma", greatest_scale_sigma,
          "at least least_scale_sigma");
}

}  // namespace lodeline
