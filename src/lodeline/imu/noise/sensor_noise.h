#pragma once

#include <array>
#include <optional>
#include <string>

#include "lodeline/imu/noise/noise_fit.h"
#include "lodeline/imu/noise/stillness_monitor.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// One sensor of three axes as the analysis names and judges it.
struct AnalysedSensor {
  std::string name;  ///< "gyroscope"
  std::string unit;  ///< of its readings, "rad/s"
  StillLimits still;
};

/// Gyroscope (rad/s), accelerometer (m/s^2) and magnetometer (T), with limits that a sensor on solid ground
/// keeps whatever its grade.
AnalysedSensor gyroscopeToAnalyse();
AnalysedSensor accelerometerToAnalyse();
AnalysedSensor magnetometerToAnalyse();

/// Noise of one sensor.
struct SensorNoise {
  AnalysedSensor sensor;
  double rate_hz = 0.0;  ///< of the readings that count
  double duration_s = 0.0;
  int64_t readings = 0;
  int64_t repeated = 0;  ///< that only repeat the one before, and were left out
  Stillness stillness;
  AllanCurve curve;
  std::array<NoiseFit, 3> axes;
  NoiseFit all;  ///< of the mean variance of the three axes
};

/// Takes the readings of one sensor at rest, in order, and finds its noise; in one pass, whatever the length.
///
/// Readings count as evenly spaced at their mean rate. A gap of more than three periods (or half again as
/// long as the pauses between bursts of readings) is filled by interpolation if it is shorter than a second,
/// and splits the record if it is longer. A sensor that is logged faster than it measures repeats readings;
/// these are left out, since a held value is not a measurement. Coarse resolution repeats values too, but
/// each axis for itself: then all count.
class SensorNoiseAnalysis {
 public:
  /// `diagnostics` must outlive the analysis.
  SensorNoiseAnalysis(AnalysedSensor sensor, Diagnostics* diagnostics);

  /// A reading that is not finite, not later than the one before, or one of two at most that lie a hundred
  /// times farther off than a still sensor scatters, is reported and passed over.
  void add(Time time, const Vec3& reading);

  /// Reports what limits the figures: a record that is short, not still, repeated, filtered, drifting. Throws
  /// InputError where there are no figures at all: too few readings, a frozen sensor, one that moved for more
  /// than half of the record.
  SensorNoise finish();

 private:
  void learnPeriod();
  bool isSpike(Time time, const Vec3& reading);
  void take(Time time, const Vec3& reading);
  void bridge(Time time, const Vec3& reading);
  bool holdsReadings() const;
  SensorNoise analysed() const;
  void requireAnalysable(const SensorNoise& noise) const;
  void reportConditions(const SensorNoise& noise) const;
  void reportFit(const SensorNoise& noise) const;

  AnalysedSensor sensor_;
  Diagnostics* diagnostics_;
  std::vector<std::pair<Time, Vec3>> first_;  ///< until they have shown the period
  double period_s_ = 0.0;
  double gap_limit_s_ = 0.0;
  std::optional<Time> begin_;
  Time last_time_;      ///< of everything added
  Time previous_time_;  ///< of what was taken
  Vec3 last_ = Vec3::Zero();
  int spikes_ = 0;  ///< on end, up to the newest reading
  int64_t readings_ = 0;
  int64_t repeated_ = 0;                    ///< in all axes at once
  std::array<int64_t, 3> repeated_axis_{};  ///< in one axis
  double split_s_ = 0.0;                    ///< length of the gaps that split the record
  StillnessMonitor stillness_;
  AllanAccumulator all_readings_;
  AllanAccumulator fresh_readings_;  ///< without the repeated ones
};

}  // namespace lodeline
