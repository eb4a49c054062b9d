#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lodeline/io/logs/binary/log_channels.h"
#include "lodeline/io/logs/readings/sensor_log.h"

namespace lodeline {

/// The sensors of a binary log of an autopilot. The log is read twice: once for its topics, then for the
/// readings, one message at a time.
class AutopilotLog : public SensorLog {
 public:
  using Open = std::function<std::unique_ptr<MessageLog>()>;

  /// `file` and `program` are for messages. Throws InputError where the log has none of the sensors.
  /// `diagnostics` must outlive the log.
  AutopilotLog(const Open& open, std::string file, const std::string& program, Diagnostics* diagnostics);

  bool next(LogReading* reading) override;

 private:
  void reportContent(const std::string& program) const;
  void reportDamage();
  /// Puts the readings of a message into `waiting_`.
  void take(const LogMessage& message);

  std::string file_;
  Diagnostics* diagnostics_;
  std::vector<LogChannel> channels_;
  std::unique_ptr<MessageLog> log_;
  std::deque<LogReading> waiting_;
};

}  // namespace lodeline
