#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lodeline {

struct HeadingFilterOptions {
  /// Error of the magnetic heading in the Earth's field, caused by nearby iron and calibration. It stays
  /// constant for the correlation time, so many readings within a second have the information of one.
  double sigma_rad = 0.05;  ///< 3 deg
  double correlation_s = 1.0;
  /// Part of that error that averaging does not reduce: residual hard iron of the calibration, misalignment.
  double systematic_sigma_rad = 0.026;       ///< 1.5 deg
  double systematic_time_constant_s = 30.0;  ///< of the part added where the field contradicts itself
  double disturbed_correlation_s = 10.0;
  double gate_sigmas = 3.0;
  /// Error growth of the gyroscope's heading: white noise, and a bias error with the correlation time below.
  double gyroscope_density_rad_per_s_sqrtHz = 3.5e-4;
  double bias_correlation_s = 10.0;
};

/// Kalman filter of one angle: the rotation that aligns the gyroscope's heading with north, counterclockwise
/// about the vertical.
class HeadingFilter {
 public:
  explicit HeadingFilter(const HeadingFilterOptions& options) : options_(options) {}

  void predict(double bias_sigma_rad_per_s, double step_s) {
    const double wander = options_.gyroscope_density_rad_per_s_sqrtHz;
    variance_ += step_s * (wander * wander +
                           bias_sigma_rad_per_s * bias_sigma_rad_per_s * options_.bias_correlation_s);
    variance_ = std::min(variance_, kUnknown);
  }

  /// Whether the innovation of a measured angle passes the gate.
  bool accepts(double measured_rad) const {
    const double innovation = std::remainder(measured_rad - offset_rad_, 2.0 * std::numbers::pi);
    const double variance = variance_ + options_.sigma_rad * options_.sigma_rad;
    return innovation * innovation <= options_.gate_sigmas * options_.gate_sigmas * variance;
  }

  /// Updates with a measured angle. `field_error_rad` is the field error that magnitude and dip show, as an
  /// angle of the horizontal part. It increases the measurement's variance where the field counts as
  /// disturbed. It increases the published variance for every reading used, because iron that rotates the
  /// field also changes its magnitude and dip.
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

  /// Increases the variance, for example for an unmeasured motion.
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
      std::numbers::pi * std::numbers::pi / 3.0;  ///< variance of a uniformly distributed angle

  HeadingFilterOptions options_;
  double offset_rad_ = 0.0;
  double variance_ = kUnknown;
  double systematic_variance_ = 0.0;  ///< variance due to the field, after its first use
  double used_s_ = 0.0;
};

}  // namespace lodeline
