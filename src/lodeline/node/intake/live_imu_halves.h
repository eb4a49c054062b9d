#pragma once

#include <deque>
#include <optional>

#include "lodeline/io/streams/imu_halves.h"

namespace lodeline {

/// Merges the readings of a gyroscope and an accelerometer that arrive one by one, as ImuHalves does. A
/// reading of the gyroscope waits until the accelerometer has one of the same time or a later one.
class LiveImuHalves {
 public:
  /// The halves differ in which of both vectors is zero.
  void add(const ImuSample& half);
  /// The next merged reading; nothing until there is one.
  std::optional<ImuSample> next();

  /// Number of readings that were dropped because the other half is silent.
  size_t dropped() const { return dropped_; }

  /// Most readings of a half that wait; ten seconds at 200 Hz.
  static constexpr size_t kMostWaiting = 2000;

 private:
  void put(const ImuSample& half, std::deque<ImuSample>* queue);

  ImuHalves halves_;
  std::deque<ImuSample> gyroscope_, accelerometer_;
  std::optional<Time> newest_force_;  ///< greatest time of the accelerometer's readings
  size_t dropped_ = 0;
};

}  // namespace lodeline
