#pragma once

#include <tuple>
#include <utility>
#include <vector>

#include "lodeline/sensors/sensor_kind.h"

namespace lodeline {

/// Readings of all sensors beside cameras and IMU, a list for each kind in order of time.
class SensorReadings {
 public:
  SensorReadings() = default;
  /// With the readings of some kinds, in any order.
  template <typename... Samples>
  explicit SensorReadings(std::vector<Samples>... lists) {
    ((of<Samples>() = std::move(lists)), ...);
  }

  template <typename Sample>
  std::vector<Sample>& of() {
    return std::get<std::vector<Sample>>(lists_);
  }
  template <typename Sample>
  const std::vector<Sample>& of() const {
    return std::get<std::vector<Sample>>(lists_);
  }
  /// Inserts the readings of `before` before those of the same kind.
  void prepend(SensorReadings before) {
    const auto put = [](auto& list, auto& earlier) {
      earlier.insert(earlier.end(), list.begin(), list.end());
      list = std::move(earlier);
    };
    std::apply(
        [&](auto&... list) {
          std::apply([&](auto&... earlier) { (put(list, earlier), ...); }, before.lists_);
        },
        lists_);
  }

 private:
  template <typename Sample>
  using List = std::vector<Sample>;
  PerSensorKind<List> lists_;
};

}  // namespace lodeline
