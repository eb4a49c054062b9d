#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lodeline {

struct HeadingFilterOptions {
  /// Error of the magnetic heading where the field is the Earth's: iron nearby, calibration. It lasts for the
  /// correlation time, so that many readings in a second say no more than one.
  double sigma_rad = 0.05;  ///< 3 deg
  double correlation_s = 1.0;
  /// What no averaging takes away of it: hard iron left by the calibration, misalignment.
  double systematic_sigma_rad = 0.026;       ///< 1.5 deg
  double systematic_time_constant_s = 30.0;  ///< of what is added where the field contradicts itself
  double disturbed_correlation_s = 10.0;
  double gate_sigmas = 3.0;
  /// The gyroscope's heading wanders by its noise, and by its bias error, which lasts for the time below.
  double gyroscope_density_rad_per_s_sqrtHz = 3.5e-4;
  double bias_correlation_s = 10.0;
};

/// Kalman filter of one angle: by how much the gyroscope's heading is to be turned, counterclockwise about
/// up, to point north.
class HeadingFilter {
 public:
  explicit HeadingFilter(const HeadingFilterOptions& options) : options_(options) {}

  void predict(double bias_sigma_rad_per_s, double step_s) {
    const double wander = options_.gyroscope_density_rad_per_s_sqrtHz;
    variance_ += step_s * (wander * wander +
                           bias_sigma_rad_per_s * bias_sigma_rad_per_s * options_.bias_correlation_s);
    variance_ = std::min(variance_, kUnknown);
  }

  /// Whether a measured angle is plausible.
  bool accepts(double measured_rad) const {
    const double innovation = std::remainder(measured_rad - offset_rad_, 2.0 * std::numbers::pi);
    const double variance = variance_ + options_.sigma_rad * options_.sigma_rad;
    return innovation * innovation <= options_.gate_sigmas * options_.gate_sigmas * variance;
  }

  /// `field_error_rad`: by how much strength and dip show the field to be off, as an angle of its horizontal
  /// part. Where it counts as disturbed, that is part of the measurement's uncertainty. It is part of the
  /// published uncertainty wherever a reading is used: iron that turns the field also changes its strength
  /// and dip.
  void correct(double measured_rad, double field_error_rad, bool is_disturbed, double step_s) {
    const double field_variance = field_error_rad * field_error_rad;
    const double density = options_.sigma_rad * options_.sigma_rad * options_.correlation_s +
                           (is_disturbed ? field_variance * options_.disturbed_correlation_s : 0.0);
    const double gain = variance_ / (variance_ + density / step_s);
    offset_rad_ += gain * std::remainder(measured_rad - offset_rad_, 2.0 * std::numbers::pi);
    variance_ *= 1.0 - gain;
    const double systematic = options_.systematic_sigma_rad * options_.systematic_sigma_rad + field_variance;
    used_s_ += step_s;
    const double share = std::max(step_s / used_s_, step_s / options_.systematic_time_constant_s);
    systematic_variance_ += std::min(1.0, share) * (systematic - systematic_variance_);
  }

  /// Adds to the uncertainty, as of a motion that nobody measured.
  void loosen(double sigma_rad) { variance_ = std::min(variance_ + sigma_rad * sigma_rad, kUnknown); }
  void forget() { variance_ = kUnknown; }
  void define(double offset_rad) {
    offset_rad_ = offset_rad;
    variance_ = 0.0;
  }

  double offset_rad() const { return offset_rad_; }
  double sigma_rad() const { return std::sqrt(std::min(variance_ + systematic_variance_, kUnknown)); }

 private:
  static constexpr double kUnknown =
      std::numbers::pi * std::numbers::pi / 3.0;  ///< any angle, equally likely

  HeadingFilterOptions options_;
  double offset_rad_ = 0.0;
  double variance_ = kUnknown;
  double systematic_variance_ = 0.0;  ///< of the field, once it was used
  double used_s_ = 0.0;
};

}  // namespace lodeline
