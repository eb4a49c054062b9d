#include "lodeline/inspection/survey/gyroscope_integral.h"

#include <algorithm>

namespace lodeline {

GyroscopeIntegral::GyroscopeIntegral(std::span<const ImuSample> samples) {
  if (samples.empty()) return;
  origin_ = samples.front().time;
  Vec3 angle = Vec3::Zero();
  for (size_t i = 0; i < samples.size(); ++i) {
    const double time_s = (samples[i].time - origin_).seconds();
    if (i > 0) {
      angle += 0.5 * (time_s - times_s_.back()) *
               (samples[i].angular_velocity_B + samples[i - 1].angular_velocity_B);
    }
    times_s_.push_back(time_s);
    angles_B_.push_back(angle);
  }
}

std::optional<Vec3> GyroscopeIntegral::angle_B(double time_s) const {
  const auto after = std::lower_bound(times_s_.begin(), times_s_.end(), time_s);
  if (after == times_s_.end() || (after == times_s_.begin() && *after > time_s)) return std::nullopt;
  const auto i = static_cast<size_t>(after - times_s_.begin());
  if (i == 0) return angles_B_.front();
  const double share = (time_s - times_s_[i - 1]) / (times_s_[i] - times_s_[i - 1]);
  return Vec3(angles_B_[i - 1] + share * (angles_B_[i] - angles_B_[i - 1]));
}

std::optional<Vec3> GyroscopeIntegral::meanRate_B(double begin_s, double end_s) const {
  const std::optional<Vec3> begin = angle_B(begin_s);
  const std::optional<Vec3> end = angle_B(end_s);
  if (!begin || !end || !(end_s > begin_s)) return std::nullopt;
  return Vec3((*end - *begin) / (end_s - begin_s));
}

}  // namespace lodeline
