#include "lodeline/io/rosbag/ros2/mcap_scan.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <set>
#include <vector>

#include "lodeline/io/rosbag/definitions/definition_parser.h"
#include "lodeline/io/rosbag/ros2/mcap_record.h"

namespace lodeline {
namespace {

using mcap::Kind;

constexpr uint64_t kLargestDefinition = uint64_t{64} << 20;
constexpr uint64_t kLargestIndex = uint64_t{256} << 20;
/// Fields of a chunk: fixed sizes and the name of the compression.
constexpr size_t kChunkFields = 256;
/// Maximum unpacked size of a chunk without a check against its packed size.
constexpr uint64_t kLargeMcapChunk = uint64_t{1} << 30;
constexpr uint64_t kGreatestMcapRatio = 256;
/// Length of a part of the file with messages outside of chunks.
constexpr uint64_t kPart = uint64_t{1} << 30;

class McapScan {
 public:
  McapScan(uint32_t file, uint32_t first_channel, ChunkCache* chunks, BagContents* contents,
           Diagnostics* diagnostics)
      : number_(file),
        first_channel_(first_channel),
        chunks_(chunks),
        file_(chunks->bytes(file)),
        contents_(contents),
        diagnostics_(diagnostics) {}

  void run() {
    checkMagic();
    uint64_t position = mcap::kMagic.size();
    while (position < file_.size() && !was_closed_) {
      const std::optional<mcap::RecordHead> head = mcap::recordHead(file_.read(position, mcap::kRecordHead));
      const uint64_t content = position + mcap::kRecordHead;
      const bool fits = head && head->size <= file_.size() - content;
      position = fits ? takeRecord(position, *head) : passDamage(position, head);
    }
    if (!was_closed_) index_is_damaged_ = true;
    finishChunk();
    findChannels();
    store();
    reportState();
  }

 private:
  using Entries = std::vector<std::pair<uint16_t, BagEntry>>;  ///< with their channels

  void checkMagic() const {
    const wire::Bytes start = file_.read(0, mcap::kMagic.size());
    if (std::string_view(reinterpret_cast<const char*>(start.data()), start.size()) == mcap::kMagic) return;
    throw InputError(fmt::format("{}: {}", file_.path().string(),
                                 start.empty() ? "empty or unreadable; an MCAP file was expected"
                                               : "no MCAP file (its first bytes are others)"));
  }

  /// Returns the position after the record.
  uint64_t takeRecord(uint64_t position, const mcap::RecordHead& head) {
    const uint64_t content = position + mcap::kRecordHead;
    try {
      switch (head.kind) {
        case Kind::Schema:
        case Kind::Channel:
        case Kind::Statistics:
          if (head.size <= kLargestDefinition) takeDescription(head.kind, file_.read(content, head.size));
          break;
        case Kind::Message:
          finishChunk();
          takeMessage(position);
          break;
        case Kind::Chunk:
          takeChunk(content, head.size, false);
          break;
        case Kind::MessageIndex:
          takeIndex(head.size > kLargestIndex ? wire::Bytes() : file_.read(content, head.size));
          break;
        case Kind::Footer:
          was_closed_ = true;
          break;
        default:
          break;
      }
    } catch (const wire::Reader::CutOff&) {
      index_is_damaged_ = index_is_damaged_ || head.kind == Kind::MessageIndex;
    }
    return content + head.size;
  }

  void takeDescription(Kind kind, std::span<const uint8_t> bytes) {
    wire::Reader content(bytes);
    if (kind == Kind::Statistics) {
      promised_messages_ = content.take<uint64_t>();
      return;
    }
    const auto id = content.take<uint16_t>();
    if (kind == Kind::Schema) {
      schemas_[id] = mcap::parseSchema(&content);
    } else {
      channels_[id] = mcap::parseChannel(&content);
    }
  }

  void takeChunk(uint64_t content, uint64_t size, bool is_cut_off) {
    finishChunk();
    const mcap::ChunkFields fields =
        mcap::parseChunk(file_.read(content, std::min<uint64_t>(size, kChunkFields)));
    const uint64_t packed = std::min(fields.packed_size, size - std::min<uint64_t>(size, fields.size));
    constexpr uint64_t kLargest = std::numeric_limits<uint32_t>::max();
    if (packed > kLargest || (!is_cut_off && fields.unpacked_size > kLargest)) {
      diagnostics_->report(Severity::Warning, "bag_chunk",
                           fmt::format("{}: the chunk at byte {} has more than 4 GB; it is passed over",
                                       file_.path().string(), content));
      return;
    }
    BagChunk chunk;
    chunk.file = number_;
    chunk.position = content + fields.size;
    chunk.packed_size = static_cast<uint32_t>(packed);
    chunk.unpacked_size = static_cast<uint32_t>(std::min(fields.unpacked_size, kLargest));
    chunk.compression = fields.compression.empty() ? "none" : fields.compression;
    chunk.checksum = fields.checksum;
    chunk.is_cut_off = is_cut_off || packed < fields.packed_size;
    if (chunk.unpacked_size > kLargeMcapChunk &&
        chunk.unpacked_size / kGreatestMcapRatio > chunk.packed_size) {
      chunk.unpacked_size = chunk.packed_size;  // the number is damaged
    }
    current_ = chunks_->add(chunk);
  }

  void takeIndex(const wire::Bytes& bytes) {
    wire::Reader content(bytes);
    const auto channel = content.take<uint16_t>();
    wire::Reader entries(content.takeSized());
    if (!current_) return;
    while (entries.remaining() > 0) {
      const auto time = entries.take<uint64_t>();
      const auto offset = entries.take<uint64_t>();
      if (offset > std::numeric_limits<uint32_t>::max()) throw wire::Reader::CutOff();
      pending_.emplace_back(channel, BagEntry{received(time), *current_, static_cast<uint32_t>(offset)});
    }
  }

  /// Adds a message outside of chunks.
  void takeMessage(uint64_t position) {
    if (!part_ || position - chunks_->chunk(*part_).position >= kPart) {
      BagChunk part;
      part.file = number_;
      part.position = position;
      part.packed_size = static_cast<uint32_t>(
          std::min<uint64_t>(file_.size() - position, std::numeric_limits<uint32_t>::max()));
      part.unpacked_size = part.packed_size;
      part.compression = "none";
      part_ = chunks_->add(part);
      parts_.insert(*part_);
    }
    const wire::Bytes fields = file_.read(position + mcap::kRecordHead, mcap::kMessageFields);
    add(fields, *part_, static_cast<uint32_t>(position - chunks_->chunk(*part_).position));
    for (auto& [channel, entry] : pending_) entries_.emplace_back(channel, entry);
    pending_.clear();
  }

  void add(std::span<const uint8_t> fields, uint32_t chunk, uint32_t offset) {
    wire::Reader content(fields);
    const auto channel = content.take<uint16_t>();
    content.take<uint32_t>();  // sequence number
    pending_.emplace_back(channel, BagEntry{received(content.take<uint64_t>()), chunk, offset});
  }

  static Time received(uint64_t time_ns) {
    return Time::fromNanoseconds(static_cast<int64_t>(
        std::min<uint64_t>(time_ns, static_cast<uint64_t>(std::numeric_limits<int64_t>::max()))));
  }

  /// Skips damaged bytes, or takes a chunk that the end of the file cuts off. Returns the position at which
  /// to continue.
  uint64_t passDamage(uint64_t position, const std::optional<mcap::RecordHead>& head) {
    const std::optional<uint64_t> next = nextChunkInSummary(position);
    const uint64_t end = next.value_or(file_.size());
    index_is_damaged_ = true;
    if (head && head->kind == Kind::Chunk && !next) {
      try {
        const uint64_t content = position + mcap::kRecordHead;
        takeChunk(content, end - content, true);
      } catch (const wire::Reader::CutOff&) {
      }
    }
    if (next) {
      diagnostics_->report(Severity::Warning, "bag_damaged",
                           fmt::format("{}: bytes {} to {} are damaged; reading goes on at the next chunk",
                                       file_.path().string(), position, end));
    } else {
      truncated_at_ = position;
    }
    return end;
  }

  /// Position of the first chunk after `position` that a chunk index in the summary names.
  std::optional<uint64_t> nextChunkInSummary(uint64_t position) {
    if (!summary_chunks_) readSummaryChunks();
    const auto next = summary_chunks_->upper_bound(position);
    if (next == summary_chunks_->end()) return std::nullopt;
    return *next;
  }

  void readSummaryChunks() {
    summary_chunks_.emplace();
    constexpr uint64_t kFooter = mcap::kRecordHead + 20 + 8;  // with the magic bytes at the end
    if (file_.size() < kFooter + mcap::kMagic.size()) return;
    const uint64_t footer = file_.size() - kFooter;
    const wire::Bytes bytes = file_.read(footer, kFooter);
    const std::optional<mcap::RecordHead> head = mcap::recordHead(bytes);
    if (!head || head->kind != Kind::Footer || head->size != 20) return;
    uint64_t at = wire::Reader(std::span(bytes).subspan(mcap::kRecordHead)).take<uint64_t>();
    while (at > 0 && at < footer) {
      const std::optional<mcap::RecordHead> record = mcap::recordHead(file_.read(at, mcap::kRecordHead));
      if (!record || record->size > footer - at) return;
      if (record->kind == Kind::ChunkIndex && record->size >= 24) {
        const wire::Bytes fields = file_.read(at + mcap::kRecordHead, 24);
        summary_chunks_->insert(wire::Reader(std::span(fields).subspan(16)).take<uint64_t>());
      }
      at += mcap::kRecordHead + record->size;
    }
  }

  /// Stores the entries of the chunk's indexes, or scans a chunk without them.
  void finishChunk() {
    if (!current_) return;
    if (pending_.empty() || index_is_damaged_) {
      pending_.clear();
      lookThrough(*current_);
    }
    entries_.insert(entries_.end(), pending_.begin(), pending_.end());
    pending_.clear();
    index_is_damaged_ = false;
    current_.reset();
  }

  void lookThrough(uint32_t number) {
    const std::shared_ptr<const Unpacked> unpacked = chunks_->unpack(number);
    const std::span<const uint8_t> bytes(unpacked->bytes);
    size_t offset = 0;
    try {
      while (offset < bytes.size()) {
        const std::span<const uint8_t> rest = bytes.subspan(offset);
        const std::optional<mcap::RecordHead> head = mcap::recordHead(rest);
        if (!head || head->size > rest.size() - mcap::kRecordHead) break;
        const std::span<const uint8_t> content = rest.subspan(mcap::kRecordHead, head->size);
        if (head->kind == Kind::Schema || head->kind == Kind::Channel) takeDescription(head->kind, content);
        if (head->kind == Kind::Message) add(content, number, static_cast<uint32_t>(offset));
        offset += mcap::kRecordHead + head->size;
      }
    } catch (const wire::Reader::CutOff&) {
    }
    const BagChunk& chunk = chunks_->chunk(number);
    const bool complete = offset == bytes.size() && unpacked->problem.empty();
    if (complete || chunk.is_cut_off) return;
    diagnostics_->report(
        Severity::Warning, "bag_chunk",
        fmt::format("{}: the chunk at byte {}: {}; {} of its messages were recovered, the rest is lost",
                    file_.path().string(), chunk.position,
                    unpacked->problem.empty() ? "its records are damaged" : unpacked->problem,
                    pending_.size()));
  }

  /// Finds the channels of messages in files without a summary, where only chunks describe them.
  void findChannels() {
    std::set<uint32_t> looked_through;
    for (size_t i = 0; i < entries_.size(); ++i) {
      const auto& [channel, entry] = entries_[i];
      const auto known = channels_.find(channel);
      if (known != channels_.end() &&
          (known->second.schema == 0 || schemas_.contains(known->second.schema))) {
        continue;
      }
      if (parts_.contains(entry.chunk) || !looked_through.insert(entry.chunk).second) continue;
      lookThrough(entry.chunk);
    }
    pending_.clear();
  }

  void store() {
    for (const auto& [id, channel] : channels_) {
      BagConnection connection;
      connection.topic = channel.topic;
      const mcap::Schema& schema = schemas_[channel.schema];
      connection.type = definitions::shortTypeName(schema.name);
      const bool is_text = schema.encoding == "ros2msg" || schema.encoding == "ros1msg";
      if (is_text) connection.definition = schema.definition;
      connection.serialization.reset();
      if (channel.encoding == "cdr") connection.serialization = definitions::Serialization::Cdr;
      if (channel.encoding == "ros1") connection.serialization = definitions::Serialization::Ros1;
      if (!connection.serialization) {
        connection.problem = fmt::format("the encoding '{}' of its messages is not read", channel.encoding);
      }
      contents_->connections[first_channel_ + id] = std::move(connection);
    }
    for (const auto& [channel, entry] : entries_) {
      contents_->entries[first_channel_ + channel].push_back(entry);
      last_ = std::max(last_, entry.received);
    }
  }

  void reportState() {
    const std::string found = fmt::format("{} messages could be recovered, the last recorded at {} ns",
                                          entries_.size(), last_.nanoseconds());
    const std::string name = file_.path().string();
    if (truncated_at_) {
      diagnostics_->report(Severity::Warning, "bag_truncated",
                           fmt::format("{}: cut off or damaged from byte {} to its end ({}); {}", name,
                                       *truncated_at_, file_.size(), found));
    } else if (!was_closed_) {
      diagnostics_->report(
          Severity::Warning, "bag_unindexed",
          fmt::format("{}: was not closed when it was recorded and has no summary; {}. What was not written "
                      "to it is lost",
                      name, found));
    } else if (promised_messages_ && entries_.size() < *promised_messages_) {
      diagnostics_->report(Severity::Warning, "bag_truncated",
                           fmt::format("{}: {}; its summary states {}", name, found, *promised_messages_));
    }
  }

  uint32_t number_;
  uint32_t first_channel_;
  ChunkCache* chunks_;
  const RandomAccessFile& file_;
  BagContents* contents_;
  Diagnostics* diagnostics_;
  std::map<uint16_t, mcap::Schema> schemas_;
  std::map<uint16_t, mcap::Channel> channels_;
  std::optional<uint32_t> current_;  ///< last chunk, whose indexes follow
  std::optional<uint32_t> part_;     ///< part of the file with messages outside of chunks
  std::set<uint32_t> parts_;
  Entries pending_;  ///< of the current chunk
  Entries entries_;
  Time last_;
  bool index_is_damaged_ = false;
  bool was_closed_ = false;
  std::optional<uint64_t> promised_messages_;
  std::optional<uint64_t> truncated_at_;
  std::optional<std::set<uint64_t>> summary_chunks_;
};

}  // namespace

void scanMcap(uint32_t file, uint32_t first_channel, ChunkCache* chunks, BagContents* contents,
              Diagnostics* diagnostics) {
  McapScan(file, first_channel, chunks, contents, diagnostics).run();
}

}  // namespace lodeline
