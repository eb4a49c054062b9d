#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/logs/binary/message_log.h"

namespace lodeline {

enum class LogSensor { Gyroscope, Accelerometer, Magnetometer, Pressure, Current };
inline constexpr size_t kLogSensors = 5;
const char* toString(LogSensor sensor);

/// The topic and fields from which the readings of one sensor are taken.
struct LogChannel {
  LogSensor sensor = LogSensor::Gyroscope;
  std::string name;  ///< of a channel of currents: battery_0, esc_3
  std::string topic;
  int instance = 0;
  size_t messages = 0;
  std::vector<std::string> fields;  ///< three, or one for a scalar
  std::string unit;                 ///< of the readings in the log
  bool is_unit_stated = false;      ///< by the log; otherwise by the documentation of its program
  std::optional<double> to_si;      ///< SI units per unit; empty for PX4's barometer, see log_channels.cpp
  /// Whether the messages state a time of their accelerometer that differs from their stamp.
  bool has_relative_time = false;
  std::vector<std::string> unused;  ///< "sensor_mag 1 (1200)": other sources, with their messages
};

/// Selects the topics of a log that hold the sensors, by one pass over it. Topics and fields are those of PX4
/// and ArduPilot. Among several topics of a sensor, the first of the table wins that has at least half of the
/// messages of the most frequent one; among several instances the lowest such one. Of
/// currents, all instances are channels that have a reading other than 0. The unit that the log states has
/// priority over the documented one. Throws InputError, with `file`, where a stated unit is not
/// known.
std::vector<LogChannel> selectChannels(MessageLog* log, const std::string& file);

/// Time of a message in ns: of its sample, else of the message; empty where it has none.
std::optional<int64_t> timeOf_ns(const LogMessage& message);

/// Delay of the accelerometer against the stamp of the message (PX4's sensor_combined), ns; 0 where it states
/// none.
int64_t relativeTime_ns(const LogMessage& message);

/// The reading of a channel in a message, in SI units: three values, or one; empty where a value is missing
/// or not finite.
std::optional<std::array<double, 3>> readingOf(const LogChannel& channel, const LogMessage& message);

}  // namespace lodeline
