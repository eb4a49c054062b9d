#include "lodeline/io/synchronizer/imu_interval.h"

#include <algorithm>

namespace lodeline {

ImuSample interpolate(const ImuSample& before, const ImuSample& after, Time time) {
  const double weight = (time - before.time).seconds() / (after.time - before.time).seconds();
  ImuSample sample;
  sample.time = time;
  sample.angular_velocity_B =
      before.angular_velocity_B + weight * (after.angular_velocity_B - before.angular_velocity_B);
  sample.specific_force_B =
      before.specific_force_B + weight * (after.specific_force_B - before.specific_force_B);
  return sample;
}

ImuIntervals::Coverage ImuIntervals::readUntil(Time time) {
  const Duration history = Duration::fromSeconds(history_s_);
  while (buffer_.empty() || buffer_.back().time < time) {
    const std::optional<ImuSample> sample = pull_();
    if (!sample) return Coverage::AfterLast;
    buffer_.push_back(*sample);
    buffer_.back().time = moved(buffer_.back().time, correction_);
    last_ = buffer_.back().time;
    span_.add(*last_);
    if (cut_before_) continue;
    // Until the first cut, old history is removed, except the last reading at or before `time`.
    const Time oldest = std::min(time, buffer_.back().time) - history;
    while (buffer_.size() > 1 && buffer_[0].time < oldest && buffer_[1].time <= time) buffer_.pop_front();
  }
  return buffer_.front().time <= time ? Coverage::Covered : Coverage::BeforeFirst;
}

std::vector<ImuSample> ImuIntervals::cut(Time time, double* longest_gap_s) {
  std::vector<ImuSample> interval;
  if (cut_before_) interval.push_back(border_);
  *longest_gap_s = 0.0;
  size_t after = 0;
  for (; buffer_[after].time < time; ++after) {
    if (interval.empty() || buffer_[after].time > interval.back().time) interval.push_back(buffer_[after]);
    buffer_[after + 1].gap_s = (buffer_[after + 1].time - buffer_[after].time).seconds();
    *longest_gap_s = std::max(*longest_gap_s, buffer_[after + 1].gap_s);
  }
  const bool exact = buffer_[after].time == time;
  border_ = exact ? buffer_[after] : interpolate(buffer_[after - 1], buffer_[after], time);
  border_.gap_s = buffer_[after].gap_s;
  interval.push_back(border_);
  const size_t spent = exact ? after : after - 1;
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(spent));
  cut_before_ = true;
  return interval;
}

std::optional<ImuIntervals::Gap> ImuIntervals::longestGap(Time from, Time to) const {
  std::optional<Gap> longest;
  for (size_t i = 1; i < buffer_.size(); ++i) {
    const Gap gap{buffer_[i - 1].time, buffer_[i].time};
    if (gap.end <= from || gap.begin >= to) continue;
    if (!longest || gap.length() > longest->length()) longest = gap;
  }
  return longest;
}

void ImuIntervals::shiftFrom(Time from, Duration by) {
  for (ImuSample& sample : buffer_) {
    if (sample.time >= from) sample.time = moved(sample.time, by);
  }
  if (last_ && *last_ >= from) last_ = moved(*last_, by);
  correction_ = correction_ + by;
}

void ImuIntervals::drain() {
  while (const std::optional<ImuSample> sample = pull_()) {
    last_ = moved(sample->time, correction_);
    span_.add(*last_);
  }
}

std::vector<ImuSample> ImuIntervals::ahead(Time time) {
  if (readUntil(time) != Coverage::Covered) return {};
  std::vector<ImuSample> interval = {border_};
  for (size_t i = 0; i < buffer_.size(); ++i) {
    if (buffer_[i].time <= border_.time) continue;
    if (buffer_[i].time >= time) {
      interval.push_back(buffer_[i].time == time ? buffer_[i]
                                                 : interpolate(interval.back(), buffer_[i], time));
      break;
    }
    interval.push_back(buffer_[i]);
  }
  return interval;
}

}  // namespace lodeline
