#include "lodeline/estimator/monitoring/vibration_monitor.h"

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

constexpr double kMemory_s = 2.0;
constexpr double kFastestVibration_hz = 160.0;

}  // namespace

VibrationMonitor::VibrationMonitor(const Rig& rig, double noise_inflation)
    : is_active_((rig.dvl || rig.currents) && rig.imu.rate_hz <= kFastestVibration_hz),
      period_s_(1.0 / std::max(rig.imu.rate_hz, 1.0)),
      stated_rate_density_(noise_inflation * rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz),
      stated_force_density_(noise_inflation * rig.imu.noise.accelerometer_density_m_per_s2_sqrtHz) {}

void VibrationMonitor::add(std::span<const ImuSample> readings) {
  if (!is_active_) return;
  const double keep = std::exp(-period_s_ / kMemory_s);
  const auto isPeriod = [this](const ImuSample& from, const ImuSample& to) {
    constexpr double kEven = 0.15;
    return std::abs((to.time - from.time).seconds() - period_s_) < kEven * period_s_;
  };
  for (const ImuSample& reading : readings) {
    if (!last_.empty() && reading.time <= last_.back().time) continue;
    if (last_.size() == 2 && isPeriod(last_[0], last_[1]) && isPeriod(last_[1], reading)) {
      rate_.add(reading.angular_velocity_B - 2.0 * last_[1].angular_velocity_B + last_[0].angular_velocity_B,
                keep);
      force_.add(reading.specific_force_B - 2.0 * last_[1].specific_force_B + last_[0].specific_force_B,
                 keep);
    }
    last_.push_back(reading);
    if (last_.size() > 2) last_.pop_front();
  }
}

InertialDoubt VibrationMonitor::doubt() const {
  InertialDoubt doubt;
  doubt.gyroscope_density_rad_per_s_sqrtHz = rate_.densityBeyond(stated_rate_density_, period_s_);
  doubt.accelerometer_density_m_per_s2_sqrtHz = force_.densityBeyond(stated_force_density_, period_s_);
  return doubt;
}

void VibrationMonitor::Shake::add(const Vec3& second_difference, double keep) {
  weight = keep * weight + 1.0;
  variance += (second_difference.squaredNorm() / 18.0 - variance) / weight;
}

double VibrationMonitor::Shake::densityBeyond(double stated_density, double period_s) const {
  constexpr double kTimesStated = 3.0;
  const double stated = kTimesStated * stated_density;
  return std::sqrt(std::max(0.0, period_s * variance - stated * stated));
}

}  // namespace lodeline
