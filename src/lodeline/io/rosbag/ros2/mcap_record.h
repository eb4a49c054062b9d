#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "lodeline/io/rosbag/chunks/wire.h"

/// Records of an MCAP file (mcap.dev/spec): a kind of one byte, a length of 8 bytes, and the content.
namespace lodeline::mcap {

inline constexpr std::string_view kMagic = "\x89MCAP0\r\n";
inline constexpr size_t kRecordHead = 9;
/// Size of the fields of a message before its data.
inline constexpr size_t kMessageFields = 22;

enum class Kind : uint8_t {
  Header = 0x01,
  Footer = 0x02,
  Schema = 0x03,
  Channel = 0x04,
  Message = 0x05,
  Chunk = 0x06,
  MessageIndex = 0x07,
  ChunkIndex = 0x08,
  Statistics = 0x0B,
  SummaryOffset = 0x0E,
  DataEnd = 0x0F,
};

struct RecordHead {
  Kind kind;
  uint64_t size = 0;  ///< of the content
};

/// The head at the front of `bytes`; nothing where they are too few or no record starts there.
std::optional<RecordHead> recordHead(std::span<const uint8_t> bytes);

struct Schema {
  std::string name, encoding, definition;
};

struct Channel {
  uint16_t schema = 0;
  std::string topic, encoding;
};

/// Parse a record's content after its number. They throw wire::Reader::CutOff.
Schema parseSchema(wire::Reader* content);
Channel parseChannel(wire::Reader* content);

/// Fields of a chunk before its records.
struct ChunkFields {
  uint64_t unpacked_size = 0;
  uint32_t checksum = 0;
  std::string compression;
  uint64_t packed_size = 0;
  size_t size = 0;  ///< number of bytes of these fields
};
ChunkFields parseChunk(std::span<const uint8_t> content);

}  // namespace lodeline::mcap
