#include "lodeline/node/intake/live_imu_halves.h"

#include <algorithm>

namespace lodeline {
namespace {

std::optional<ImuSample> takeFirst(std::deque<ImuSample>* queue) {
  if (queue->empty()) return std::nullopt;
  const ImuSample first = queue->front();
  queue->pop_front();
  return first;
}

}  // namespace

void LiveImuHalves::put(const ImuSample& half, std::deque<ImuSample>* queue) {
  queue->push_back(half);
  if (queue->size() <= kMostWaiting) return;
  queue->pop_front();
  ++dropped_;
}

void LiveImuHalves::add(const ImuSample& half) {
  if (!half.angular_velocity_B.isZero(0.0)) return put(half, &gyroscope_);
  put(half, &accelerometer_);
  newest_force_ = std::max(newest_force_.value_or(half.time), half.time);
}

std::optional<ImuSample> LiveImuHalves::next() {
  const auto gyroscope = [this]() -> std::optional<ImuSample> {
    if (gyroscope_.empty() || !newest_force_ || gyroscope_.front().time > *newest_force_) return std::nullopt;
    return takeFirst(&gyroscope_);
  };
  return halves_.next(gyroscope, [this] { return takeFirst(&accelerometer_); });
}

}  // namespace lodeline
