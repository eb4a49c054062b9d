#include "lodeline/io/rosbag1/bag_file.h"

#include <fmt/core.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag1/record.h"

namespace lodeline {
namespace {

/// Size of the first read; includes every complete message except images.
constexpr size_t kMessageAtOnce = 1024;

std::vector<BagTopic> collectTopics(BagContents contents) {
  std::vector<BagTopic> topics;
  for (const auto& numbered : contents.connections) {
    const auto& connection = numbered.second;
    std::vector<BagEntry>& entries = contents.entries[numbered.first];
    if (entries.empty()) continue;
    auto topic = std::find_if(topics.begin(), topics.end(), [&](const BagTopic& known) {
      return known.connection.topic == connection.topic && known.connection.type == connection.type &&
             known.connection.md5sum == connection.md5sum;
    });
    if (topic == topics.end()) topic = topics.insert(topics.end(), {connection, {}});
    topic->entries.insert(topic->entries.end(), entries.begin(), entries.end());
  }
  for (BagTopic& topic : topics) {
    std::stable_sort(topic.entries.begin(), topic.entries.end(),
                     [](const BagEntry& a, const BagEntry& b) { return a.received < b.received; });
  }
  std::sort(topics.begin(), topics.end(), [](const BagTopic& a, const BagTopic& b) {
    return std::tie(a.connection.topic, a.connection.type) < std::tie(b.connection.topic, b.connection.type);
  });
  return topics;
}

}  // namespace

BagFile::BagFile(const std::filesystem::path& file, Diagnostics* diagnostics)
    : chunks_(file), diagnostics_(diagnostics), topics_(collectTopics(scanBag(&chunks_, diagnostics))) {
  if (topics_.empty()) throw InputError(file.string() + ": holds no message that could be read");
}

std::optional<wire::Bytes> BagFile::read(const BagEntry& entry) {
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
