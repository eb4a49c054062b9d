#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "lodeline/io/rosbag1/wire.h"

namespace lodeline {

/// Kinds of records in a bag of format 2.0 (wiki.ros.org/Bags/Format/2.0).
enum class RecordKind : uint8_t {
  Message = 0x02,
  BagHeader = 0x03,
  Index = 0x04,
  Chunk = 0x05,
  ChunkInfo = 0x06,
  Connection = 0x07,
};

/// Named values, as they stand at the head of a record and in the data of a connection's record.
class RecordFields {
 public:
  /// Nothing where the bytes are no list of named values.
  static std::optional<RecordFields> parse(std::span<const uint8_t> bytes);

  /// Nothing where there is no such field, or one of another size.
  std::optional<RecordKind> kind() const;
  std::optional<uint32_t> number32(const std::string& name) const;
  std::optional<uint64_t> number64(const std::string& name) const;
  /// Empty where there is no such field.
  std::string text(const std::string& name) const;

 private:
  template <typename Number>
  std::optional<Number> number(const std::string& name) const;

  std::map<std::string, wire::Bytes> fields_;
};

/// A record among bytes in memory: `header_size` bytes of fields, then `data`, after the sizes of both.
struct RecordView {
  RecordFields fields;
  RecordKind kind = RecordKind::Message;
  uint32_t data_size = 0;  ///< as the record says, whether all of it is there or not
  size_t data_offset = 0;  ///< of the data from the record's first byte on
};

/// The record that starts at the first of `bytes`; nothing where there is none, or where its fields are not
/// all there. Its data may lie beyond them.
std::optional<RecordView> recordAt(std::span<const uint8_t> bytes);

}  // namespace lodeline
