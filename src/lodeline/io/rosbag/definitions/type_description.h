#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

/// Descriptions of message types, as read from the definitions in a bag.
namespace lodeline::definitions {

/// Serialization of messages.
enum class Serialization : uint8_t { Ros1, Cdr };

enum class FieldKind : uint8_t {
  Bool,
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Int64,
  UInt64,
  Float32,
  Float64,
  String,
  WideString,
  Message,
};

enum class Repetition : uint8_t { Single, Fixed, Variable };

struct Field {
  std::string name;
  FieldKind kind = FieldKind::UInt8;
  size_t message = 0;  ///< index in TypeDescription::messages, for FieldKind::Message
  Repetition repetition = Repetition::Single;
  uint32_t count = 1;  ///< number of elements of a fixed array
};

struct MessageDescription {
  std::string name;  ///< e.g. "sensor_msgs/Imu"
  std::vector<Field> fields;
};

/// The field that ROS 2 gives a message without fields.
inline constexpr const char* kPlaceholder = "structure_needs_at_least_one_member";

/// A message type and all types in its fields; the type itself is the first. No type contains itself.
struct TypeDescription {
  std::vector<MessageDescription> messages;

  const MessageDescription& root() const { return messages.front(); }
};

/// A definition that cannot be used; the text gives the reason.
class DefinitionError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Number of bytes of a number; 0 for strings and messages.
constexpr size_t sizeOf(FieldKind kind) {
  switch (kind) {
    case FieldKind::Bool:
    case FieldKind::Int8:
    case FieldKind::UInt8:
      return 1;
    case FieldKind::Int16:
    case FieldKind::UInt16:
      return 2;
    case FieldKind::Int32:
    case FieldKind::UInt32:
    case FieldKind::Float32:
      return 4;
    case FieldKind::Int64:
    case FieldKind::UInt64:
    case FieldKind::Float64:
      return 8;
    default:
      return 0;
  }
}

}  // namespace lodeline::definitions
