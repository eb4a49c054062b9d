#include "lodeline/io/rosbag/ros1/ros1_bag.h"

#include <fmt/core.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/ros1/bag_scan.h"
#include "lodeline/io/rosbag/ros1/record.h"

namespace lodeline {
Ros1Bag::Ros1Bag(const std::filesystem::path& file, Diagnostics* diagnostics)
    : BagFile(diagnostics), chunks_(file) {
  setTopics(scanBag(&chunks_, diagnostics));
}

std::optional<wire::Bytes> Ros1Bag::stored(const BagEntry& entry) {
  wire::Bytes bytes = chunks_.read(entry.chunk, entry.offset, kMessageAtOnce);
  const std::optional<RecordView> record = recordAt(bytes);
  if (record && record->kind == RecordKind::Message) {
    const size_t end = record->data_offset + record->data_size;
    if (end <= bytes.size()) {
      return wire::Bytes(bytes.begin() + static_cast<std::ptrdiff_t>(record->data_offset),
                         bytes.begin() + static_cast<std::ptrdiff_t>(end));
    }
    bytes = chunks_.read(entry.chunk, entry.offset + static_cast<uint32_t>(record->data_offset),
                         record->data_size);
    if (bytes.size() == record->data_size) return bytes;
  }
  const BagChunk& chunk = chunks_.chunk(entry.chunk);
  const std::string reason = chunk.compression == "none" ? "" : chunks_.unpack(entry.chunk)->problem;
  diagnostics_->report(
      Severity::Warning, "bag_chunk",
      fmt::format("{}: the chunk at byte {}: {}; messages from {} ns on are lost", file().string(),
                  chunk.position, reason.empty() ? "its records are damaged" : reason,
                  entry.received.nanoseconds()));
  return std::nullopt;
}

}  // namespace lodeline
