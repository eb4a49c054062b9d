#include "simulation/sensors/imu_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lodeline {

DriftingBias::DriftingBias(const TriadErrors& errors, Random random)
    : errors_(errors), random_(std::move(random)), walk_(errors.turn_on_bias) {
  // For time constants spaced by a ratio r, equal variances s^2 = ln(r) B^2 / pi approximate the two-sided
  // spectrum B^2 / (2 pi f) of IEEE 952.
  const double sigma = errors.bias_instability * std::sqrt(0.5 * std::numbers::ln10 / std::numbers::pi);
  value_ = walk_;
  for (Vec3& process : flicker_) {
    process = sigma * random_.normal3();
    value_ += process;
  }
}

void DriftingBias::advance(double step_s) {
  if (errors_.random_walk == 0.0 && errors_.bias_instability == 0.0) return;
  walk_ += errors_.random_walk * std::sqrt(step_s) * random_.normal3();
  value_ = walk_;
  if (errors_.bias_instability == 0.0) return;
  const double sigma = errors_.bias_instability * std::sqrt(0.5 * std::numbers::ln10 / std::numbers::pi);
  double time_constant_s = kShortestTime_s;
  for (Vec3& process : flicker_) {
    const double keep = std::exp(-step_s / time_constant_s);
    process = keep * process + sigma * std::sqrt(1.0 - keep * keep) * random_.normal3();
    value_ += process;
    time_constant_s *= std::sqrt(10.0);
  }
}

ImuModel::ImuModel(const ImuErrors& errors, double rate_hz, uint64_t seed)
    : errors_(errors),
      rate_hz_(rate_hz),
      gyroscope_drift_(errors.gyroscope, Random(seed, "imu/gyroscope/bias")),
      accelerometer_drift_(errors.accelerometer, Random(seed, "imu/accelerometer/bias")),
      white_(seed, "imu/white") {}

ImuSample ImuModel::measure(const ImuSample& perfect) {
  if (!started_) {
    start_ = perfect.time;
    started_ = true;
  } else {
    const double step_s = (perfect.time - last_).seconds();
    gyroscope_drift_.advance(step_s);
    accelerometer_drift_.advance(step_s);
  }
  last_ = perfect.time;

  const double t = (perfect.time - start_).seconds();
  const auto read = [&](const Vec3& truth, const TriadErrors& e, const Vec3& drift, Vec3* bias) {
    const Vec3 noise = e.noise_density * std::sqrt(rate_hz_) * white_.normal3();
    *bias = drift + e.warm_up * std::exp(-t / e.warm_up_time_s);
    const Vec3 reading = e.matrix * truth + *bias + noise;
    return Vec3(reading.cwiseMax(-e.range).cwiseMin(e.range));
  };
  ImuSample sample;
  sample.time = perfect.time;
  sample.angular_velocity_B =
      read(perfect.angular_velocity_B + errors_.g_sensitivity * perfect.specific_force_B, errors_.gyroscope,
           gyroscope_drift_.value(), &gyroscope_bias_);
  sample.specific_force_B = read(perfect.specific_force_B, errors_.accelerometer,
                                 accelerometer_drift_.value(), &accelerometer_bias_);
  return sample;
}

}  // namespace lodeline
