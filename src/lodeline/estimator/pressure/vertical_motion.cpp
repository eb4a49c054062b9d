#include "lodeline/estimator/pressure/vertical_motion.h"

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

// Time span kept: five time constants of the slowest reasonable gauge (2 s), plus the time between its
// readings.
constexpr double kKept_s = 15.0;

}  // namespace

void VerticalMotion::add(Time time, double speed_m_per_s) {
  while (!speeds_.empty() && speeds_.back().time >= time) speeds_.pop_back();
  speeds_.push_back({time, speed_m_per_s});
  while ((time - speeds_.front().time).seconds() > kKept_s) speeds_.pop_front();
}

double VerticalMotion::speedAt(Time time) const {
  const auto after = std::lower_bound(speeds_.begin(), speeds_.end(), time,
                                      [](const Speed& speed, Time wanted) { return speed.time < wanted; });
  if (after == speeds_.end()) return speeds_.back().speed_m_per_s;
  if (after == speeds_.begin()) return after->speed_m_per_s;
  const auto before = std::prev(after);
  const double share = (time - before->time).seconds() / (after->time - before->time).seconds();
  return before->speed_m_per_s + share * (after->speed_m_per_s - before->speed_m_per_s);
}

double VerticalMotion::risen(Time from, Time to) const {
  double rise_m = 0.0;
  Time begin = from;
  double begin_speed = speedAt(from);
  const auto stepTo = [&](Time end, double end_speed) {
    rise_m += 0.5 * (begin_speed + end_speed) * (end - begin).seconds();
    begin = end;
    begin_speed = end_speed;
  };
  for (const Speed& speed : speeds_) {
    if (speed.time > from && speed.time < to) stepTo(speed.time, speed.speed_m_per_s);
  }
  stepTo(to, speedAt(to));
  return rise_m;
}

double VerticalMotion::riseSince(Time from, Time to, double lag_s) const {
  if (speeds_.empty()) return 0.0;
  const double since_m = risen(from, to);
  if (lag_s <= 0.0) return since_m + lag_s * speedAt(from);
  // The sensor's delay w in metres obeys w' = v - w / lag.
  double behind_m = 0.0;
  Time begin = speeds_.front().time;
  double begin_speed = speeds_.front().speed_m_per_s;
  const auto stepTo = [&](Time end, double end_speed) {
    const double keep = std::exp(-(end - begin).seconds() / lag_s);
    behind_m = keep * behind_m + (1.0 - keep) * lag_s * 0.5 * (begin_speed + end_speed);
    begin = end;
    begin_speed = end_speed;
  };
  for (const Speed& speed : speeds_) {
    if (speed.time > begin && speed.time < from) stepTo(speed.time, speed.speed_m_per_s);
  }
  if (from > begin) stepTo(from, speedAt(from));
  return since_m + behind_m;
}

}  // namespace lodeline
