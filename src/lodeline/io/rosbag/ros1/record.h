#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "lodeline/io/rosbag/chunks/wire.h"

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

/// Named values, as in the header of a record and in the data of a connection's record.
class RecordFields {
 public:
  /// Returns nothing where the bytes are not a list of named values.
  static std::optional<RecordFields> parse(std::span<const uint8_t> bytes);

  /// Value of a field; nothing where the field is missing or has another size.
  std::optional<RecordKind> kind() const;
  std::optional<uint32_t> number32(const std::string& name) const;
  std::optional<uint64_t> number64(const std::string& name) const;
  /// Value of a field; empty where the field is missing.
  std::string text(const std::string& name) const;

 private:
  template <typename Number>
  std::optional<Number> number(const std::string& name) const;

  std::map<std::string, wire::Bytes> fields_;
};

/// A record in memory: the sizes of both parts, `header_size` bytes of fields, then `data`.
struct RecordView {
  RecordFields fields;
  RecordKind kind = RecordKind::Message;
  uint32_t data_size = 0;  ///< as stated in the record, even where the data is incomplete
  size_t data_offset = 0;  ///< offset of the data from the first byte of the record
};

/// Parses the record that starts at the first of `bytes`. Its data may exceed them. Returns nothing where
/// there is no record, or where its fields are incomplete.
std::optional<RecordView> recordAt(std::span<const uint8_t> bytes);

}  // namespace lodeline
