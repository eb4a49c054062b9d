#include "lodeline/imu/noise/imu_noise_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr double kWindow_s = 0.25;
constexpr size_t kLeastReadings = 12;

bool isEven(std::span<const ImuSample> window, double step_s) {
  const double length_s = (window.back().time - window.front().time).seconds();
  return length_s < 1.2 * step_s * static_cast<double>(window.size() - 1);
}

/// Variance of the white noise of one axis.
double variance(std::span<const ImuSample> window, Vec3 ImuSample::*reading) {
  double squares = 0.0;
  for (size_t i = 3; i < window.size(); ++i) {
    const Vec3 third =
        window[i].*reading - window[i - 3].*reading - 3.0 * (window[i - 1].*reading - window[i - 2].*reading);
    squares += third.squaredNorm();
  }
  return squares / (3.0 * 20.0 * static_cast<double>(window.size() - 3));
}

double leastChange(std::span<const ImuSample> samples, Vec3 ImuSample::*reading) {
  double least = INFINITY;
  for (size_t i = 1; i < samples.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const double change = std::abs((samples[i].*reading)[axis] - (samples[i - 1].*reading)[axis]);
      if (change > 0.0) least = std::min(least, change);
    }
  }
  return std::isfinite(least) ? least : 0.0;
}

double density(std::span<const ImuSample> samples, Vec3 ImuSample::*reading, double worst) {
  const double step_s = medianStep_s(samples);
  if (!(step_s > 0.0)) return 0.0;
  const auto size = std::max(kLeastReadings, static_cast<size_t>(kWindow_s / step_s));
  double least = INFINITY;
  for (size_t begin = 0; begin + size <= samples.size(); begin += size / 2) {
    const std::span<const ImuSample> window = samples.subspan(begin, size);
    if (isEven(window, step_s)) least = std::min(least, variance(window, reading));
  }
  const double resolution = leastChange(samples, reading);
  const double result = std::sqrt((least + resolution * resolution / 12.0) * step_s);
  return result < worst ? result : 0.0;
}

/// Checks the noise of one sensor (gyroscope or accelerometer).
class Judge {
 public:
  Judge(const char* sensor, const char* unit, double least, Diagnostics* diagnostics)
      : sensor_(sensor), unit_(unit), least_(least), diagnostics_(diagnostics) {}

  double white(double stated, double shown, double common) const {
    constexpr double kTooSmall = 3.0, kTooLarge = 8.0;
    // The quietest window has less noise than most, and filters within the sensor remove a part.
    constexpr double kMore = 1.5;
    if (stated < least_) {
      const double taken = shown > least_ ? kMore * shown : common;
      report(Severity::Warning, "imu_noise_too_small",
             fmt::format(
                 "no {0} has a noise density of {1:.3g} {2}/sqrt(Hz): the best for navigation have {3:.1g}; "
                 "{4:.3g} is taken, {5}",
                 sensor_, stated, unit_, least_, taken,
                 shown > least_ ? "as its readings scatter" : "that of a common one"));
      return taken;
    }
    if (stated * kTooSmall < shown) {
      report(Severity::Warning, "imu_noise_too_small",
             fmt::format("the {0}'s noise density of {1:.3g} {2}/sqrt(Hz) cannot be: at its quietest its "
                         "readings scatter by {3:.3g}; {4:.3g} is taken",
                         sensor_, stated, unit_, shown, kMore * shown));
      return kMore * shown;
    }
    // Readings with less noise than any MEMS sensor's are simulated.
    constexpr double kSimulated = 30.0;
    if (shown > kSimulated * least_ && stated > kTooLarge * shown) {
      report(Severity::Notice, "imu_noise_too_large",
             fmt::format(
                 "the {0}'s noise density of {1:.3g} {2}/sqrt(Hz) is {3:.0f} times what its readings show "
                 "at rest ({4:.3g}): the estimate relies on them less than it could, unless a low-pass "
                 "filter hides their noise",
                 sensor_, stated, unit_, stated / shown, shown));
    }
    return stated;
  }

  double walk(double stated, double white) const {
    constexpr double kLeastShare = 1e-4, kCommonShare = 0.1;
    if (stated >= kLeastShare * white) return stated;
    report(
        Severity::Warning, "imu_noise_too_small",
        fmt::format(
            "the {0}'s random walk of {1:.3g} {2}/s/sqrt(Hz) cannot be beside white noise of {3:.3g}: "
            "its bias would outgrow that only after {4:.0f} hours; {5:.3g} is taken, that of a common "
            "sensor",
            sensor_, stated, unit_, white, std::sqrt(3.0) * white / stated / 3600.0, kCommonShare * white));
    return kCommonShare * white;
  }

 private:
  void report(Severity severity, const char* kind, const std::string& message) const {
    diagnostics_->report(
        severity, kind,
        message + ". Take the calibration file's figures from the data sheet or `lodeline allan`");
  }

  const char* sensor_;
  const char* unit_;
  double least_;
  Diagnostics* diagnostics_;
};

}  // namespace

WhiteNoise whiteNoiseOf(std::span<const ImuSample> samples) {
  constexpr double kWorstGyroscope = 6e-4, kWorstAccelerometer = 1e-2;
  if (samples.size() < kLeastReadings) return {};
  return {density(samples, &ImuSample::angular_velocity_B, kWorstGyroscope),
          density(samples, &ImuSample::specific_force_B, kWorstAccelerometer)};
}

ImuNoise plausibleNoise(const ImuNoise& stated, const WhiteNoise& shown, Diagnostics* diagnostics) {
  constexpr double kBestGyroscope = 3e-7, kBestAccelerometer = 1e-5;
  const ImuNoise common;
  const Judge gyroscope("gyroscope", "rad/s", kBestGyroscope, diagnostics);
  const Judge accelerometer("accelerometer", "m/s^2", kBestAccelerometer, diagnostics);
  ImuNoise noise;
  noise.gyroscope_density_rad_per_s_sqrtHz =
      gyroscope.white(stated.gyroscope_density_rad_per_s_sqrtHz, shown.gyroscope_rad_per_s_sqrtHz,
                      common.gyroscope_density_rad_per_s_sqrtHz);
  noise.gyroscope_random_walk_rad_per_s2_sqrtHz = gyroscope.walk(
      stated.gyroscope_random_walk_rad_per_s2_sqrtHz, noise.gyroscope_density_rad_per_s_sqrtHz);
  noise.accelerometer_density_m_per_s2_sqrtHz =
      accelerometer.white(stated.accelerometer_density_m_per_s2_sqrtHz, shown.accelerometer_m_per_s2_sqrtHz,
                          common.accelerometer_density_m_per_s2_sqrtHz);
  noise.accelerometer_random_walk_m_per_s3_sqrtHz = accelerometer.walk(
      stated.accelerometer_random_walk_m_per_s3_sqrtHz, noise.accelerometer_density_m_per_s2_sqrtHz);
  return noise;
}

}  // namespace lodeline
