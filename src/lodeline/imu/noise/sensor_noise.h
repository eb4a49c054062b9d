#pragma once

#include <array>
#include <optional>
#include <string>

#include "lodeline/diagnostics.h"
#include "lodeline/imu/noise/noise_fit.h"
#include "lodeline/imu/noise/stillness_monitor.h"

namespace lodeline {

/// Name, unit and limits of a three-axis sensor to analyse.
struct AnalysedSensor {
  std::string name;  ///< "gyroscope"
  std::string unit;  ///< of its readings, e.g. "rad/s"
  StillLimits still;
};

/// Gyroscope (rad/s), accelerometer (m/s^2) and magnetometer (T), with limits that a stationary sensor of any
/// grade satisfies.
AnalysedSensor gyroscopeToAnalyse();
AnalysedSensor accelerometerToAnalyse();
AnalysedSensor magnetometerToAnalyse();

/// Noise of one sensor.
struct SensorNoise {
  AnalysedSensor sensor;
  double rate_hz = 0.0;  ///< of the readings used
  double duration_s = 0.0;
  int64_t readings = 0;
  int64_t repeated = 0;  ///< number of repeated readings that were left out
  Stillness stillness;
  AllanCurve curve;
  std::array<NoiseFit, 3> axes;
  NoiseFit all;  ///< fit of the mean variance of the three axes
};

/// Estimates the noise of one stationary sensor from its readings in order of time, in one pass at any
/// length.
///
/// The readings are treated as evenly spaced at their mean rate. A gap is longer than three periods, or
/// longer than 1.5 pauses between bursts of readings. Interpolation fills gaps shorter than a second; longer
/// gaps split the record. A sensor that is logged faster than it measures repeats readings. They are left
/// out, since a held value is not a measurement. Coarse resolution also repeats values, but independently in
/// each axis; all readings are then used.
class SensorNoiseAnalysis {
 public:
  /// `diagnostics` must outlive the analysis.
  SensorNoiseAnalysis(AnalysedSensor sensor, Diagnostics* diagnostics);

  /// Adds a reading. Readings that are not finite or not later than the previous one are reported and
  /// ignored. So are at most two consecutive readings that differ by a hundred times the scatter of a
  /// stationary sensor.
  void add(Time time, const Vec3& reading);

  /// Returns the result and reports its limitations: a record that is short, not stationary, repeated,
  /// filtered or drifting. Throws InputError where no result is possible: too few readings, times that stand
  /// still or run backwards, a frozen sensor, or a sensor that moved for more than half of the record.
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
  std::vector<std::pair<Time, Vec3>> first_;  ///< readings held until the period is known
  double period_s_ = 0.0;
  double gap_limit_s_ = 0.0;
  std::vector<Time> stamps_;  ///< the first ones, in stored order
  int64_t disordered_ = 0;    ///< readings that were not later than the one before
  std::optional<Time> begin_;
  Time last_time_;      ///< of all added readings
  Time previous_time_;  ///< of the accepted readings
  Vec3 last_ = Vec3::Zero();
  int spikes_ = 0;  ///< number of consecutive spikes up to the newest reading
  int64_t readings_ = 0;
  int64_t repeated_ = 0;                    ///< in all axes at once
  std::array<int64_t, 3> repeated_axis_{};  ///< in one axis
  double split_s_ = 0.0;                    ///< total length of the gaps that split the record
  StillnessMonitor stillness_;
  AllanAccumulator all_readings_;
  AllanAccumulator fresh_readings_;  ///< without the repeated readings
};

}  // namespace lodeline
