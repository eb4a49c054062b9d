#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/csv/plain_csv.h"

namespace lodeline {

/// Current of one channel of a log.
struct LogCurrent {
  size_t channel = 0;  ///< in LogSensors::current_channels
  double current_A = 0.0;
};

/// Readings of a log with one stamp, in SI units. Sensors without a reading at that time are empty.
struct LogReading : PlainReading {
  std::optional<double> pressure_Pa;  ///< of a barometer or a water pressure sensor, absolute
  std::vector<LogCurrent> currents;   ///< of batteries, positive while they supply, and of motors
};

/// Sensors of a log, and what is known of them.
struct LogSensors {
  bool has_gyroscope = false, has_accelerometer = false, has_magnetometer = false;
  /// Whether each reading with an angular velocity has the specific force of the same time.
  bool has_whole_imu = false;
  bool has_times = true;  ///< false: the stamps only number the readings, 10 ms apart
  /// Whether the unit of the field is known. Otherwise the readings have the numbers of the file.
  bool states_field_unit = false;
  bool has_relative_field = false;            ///< see PlainCsv::hasRelativeField()
  std::vector<std::string> current_channels;  ///< names: battery_0, …, esc_0, …
  size_t fastest_current = 0;                 ///< the channel with the most readings
};

/// A log of inertial, magnetic and other readings, read once from its beginning to its end.
class SensorLog {
 public:
  virtual ~SensorLog() = default;
  /// Reads the next reading in the order of the log; returns false at the end.
  virtual bool next(LogReading* reading) = 0;
  const LogSensors& sensors() const { return sensors_; }

 protected:
  LogSensors sensors_;
};

}  // namespace lodeline
