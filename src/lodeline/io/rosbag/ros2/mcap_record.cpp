#include "lodeline/io/rosbag/ros2/mcap_record.h"

namespace lodeline::mcap {

std::optional<RecordHead> recordHead(std::span<const uint8_t> bytes) {
  if (bytes.size() < kRecordHead || bytes[0] == 0) return std::nullopt;
  wire::Reader reader(bytes);
  const auto kind = static_cast<Kind>(reader.take<uint8_t>());
  return RecordHead{kind, reader.take<uint64_t>()};
}

Schema parseSchema(wire::Reader* content) {
  Schema schema;
  schema.name = content->takeText();
  schema.encoding = content->takeText();
  schema.definition = content->takeText();
  return schema;
}

Channel parseChannel(wire::Reader* content) {
  Channel channel;
  channel.schema = content->take<uint16_t>();
  channel.topic = content->takeText();
  channel.encoding = content->takeText();
  return channel;
}

ChunkFields parseChunk(std::span<const uint8_t> content) {
  wire::Reader reader(content);
  ChunkFields fields;
  reader.take<uint64_t>();  // times of the first and the last message
  reader.take<uint64_t>();
  fields.unpacked_size = reader.take<uint64_t>();
  fields.checksum = reader.take<uint32_t>();
  fields.compression = reader.takeText();
  fields.packed_size = reader.take<uint64_t>();
  fields.size = content.size() - reader.remaining();
  return fields;
}

}  // namespace lodeline::mcap
