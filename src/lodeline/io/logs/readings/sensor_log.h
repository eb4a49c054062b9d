#pragma once

#include <optional>

#include "lodeline/io/csv/plain_csv.h"

namespace lodeline {

/// Readings of a log with one stamp, in SI units. Sensors without a reading at that time are empty.
struct LogReading : PlainReading {
  std::optional<double> pressure_Pa;  ///< of a barometer or a water pressure sensor, absolute
  std::optional<double> current_A;    ///< of the battery, positive while it supplies
};

/// Sensors of a log, and what is known of them.
struct LogSensors {
  bool has_gyroscope = false, has_accelerometer = false, has_magnetometer = false;
  /// Whether each reading with an angular velocity has the specific force of the same time.
  bool has_whole_imu = false;
  bool has_times = true;  ///< false: the stamps only number the readings, 10 ms apart
  /// Whether the unit of the field is known. Otherwise the readings have the numbers of the file.
  bool states_field_unit = false;
  bool has_relative_field = false;  ///< see PlainCsv::hasRelativeField()
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
