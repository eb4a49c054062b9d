#include "lodeline/estimator/dvl/ping_integrator.h"

#include <algorithm>
#include <iterator>
#include <vector>

#include "lodeline/io/synchronizer/imu_interval.h"

namespace lodeline {

void PingIntegrator::add(std::span<const ImuSample> samples) {
  for (const ImuSample& sample : samples) {
    if (samples_.empty() || sample.time > samples_.back().time) samples_.push_back(sample);
  }
  if (samples_.empty()) return;
  // One reading before that time is needed, too.
  const Time oldest = samples_.back().time - Duration::fromSeconds(kLongest_s);
  while (samples_.size() > 2 && samples_[1].time < oldest) samples_.pop_front();
}

std::optional<PingMotion> PingIntegrator::motion(Time ping, const NavigationState& frame) const {
  const auto isBefore = [](const ImuSample& sample, Time time) { return sample.time < time; };
  const auto first = std::lower_bound(samples_.begin(), samples_.end(), ping, isBefore);
  const auto last = std::lower_bound(first, samples_.end(), frame.time, isBefore);
  if (last == samples_.end() || last->time != frame.time) return std::nullopt;
  if (first->time != ping && first == samples_.begin()) return std::nullopt;
  const ImuSample at_ping = first->time == ping ? *first : interpolate(*std::prev(first), *first, ping);
  if (first == last && first->time == ping) {
    PingMotion none;
    none.rate_B = at_ping.angular_velocity_B;
    return none;
  }
  std::vector<ImuSample> samples = {at_ping};
  samples.insert(samples.end(), first->time == ping ? std::next(first) : first, std::next(last));
  return PingMotion(
      Preintegration(samples, frame.gyroscope_bias_B, frame.accelerometer_bias_B, imu_, options_),
      at_ping.angular_velocity_B);
}

}  // namespace lodeline
