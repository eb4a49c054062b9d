#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lodeline {

enum class FieldType { Int8, UInt8, Int16, UInt16, Int32, UInt32, Int64, UInt64, Float, Double };
size_t sizeOf(FieldType type);

/// One number in the messages of a topic.
struct LogField {
  std::string name;  ///< with the index for a part of an array: "gyro_rad[0]"
  FieldType type = FieldType::Float;
  size_t offset = 0;    ///< from the start of the payload, bytes
  double factor = 1.0;  ///< units per count
  std::string unit;     ///< as the log states it; empty where it states none
};

/// The layout of the messages of one topic.
struct LogFormat {
  std::string topic;
  std::vector<LogField> fields;

  const LogField* field(std::string_view name) const;
};

/// One message. Its parts are valid until the next call of MessageLog::next().
struct LogMessage {
  const LogFormat* format = nullptr;
  int instance = 0;  ///< number of the sensor, from 0
  std::span<const uint8_t> payload;

  /// The value of a field in its unit; empty where the message ends before it.
  std::optional<double> value(const LogField& field) const;
  /// The count of an integer field; empty for others and where the message ends before it.
  std::optional<int64_t> count(const LogField& field) const;
};

/// Bytes of a log that are no messages.
struct LogDamage {
  uint64_t bytes = 0;
  int places = 0;
  bool is_cut_off = false;  ///< the file ends within a message

  void passOver(uint64_t count) {
    bytes += count;
    ++places;
  }
};

/// A self-describing binary log as a sequence of messages. Damaged parts are skipped and counted.
class MessageLog {
 public:
  virtual ~MessageLog() = default;
  /// Reads the next message with data; returns false at the end.
  virtual bool next(LogMessage* message) = 0;
  const LogDamage& damage() const { return damage_; }

 protected:
  LogDamage damage_;
};

}  // namespace lodeline
