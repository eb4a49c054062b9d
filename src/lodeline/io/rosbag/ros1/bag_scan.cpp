#include "lodeline/io/rosbag/ros1/bag_scan.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/ros1/record.h"
#include "lodeline/util/files/file_kind.h"

namespace lodeline {
namespace {

constexpr std::string_view kVersion = "#ROSBAG V2.0\n";
/// Includes the fields of every record except unusual connections, which are read again.
constexpr size_t kFieldsAtOnce = 512;
constexpr size_t kLongestFields = 1 << 20;
/// Maximum unpacked size of a chunk without a check against its packed size.
constexpr uint64_t kLargeChunk = uint64_t{1} << 30;
constexpr uint64_t kGreatestRatio = 256;

/// The field that identifies the record of a chunk, preceded by its size.
constexpr std::array<uint8_t, 8> kChunkMark = {4, 0, 0, 0, 'o', 'p', '=', 5};

std::optional<RecordView> recordIn(const RandomAccessFile& file, uint64_t position) {
  wire::Bytes bytes = file.read(position, kFieldsAtOnce);
  if (bytes.size() < 8) return std::nullopt;
  const size_t fields_size = wire::Reader(bytes).take<uint32_t>();
  if (fields_size > kLongestFields) return std::nullopt;
  if (fields_size + 8 > bytes.size()) bytes = file.read(position, fields_size + 8);
  return recordAt(bytes);
}

/// Position of the next record of a chunk at or after `from`.
std::optional<uint64_t> findChunk(const RandomAccessFile& file, uint64_t from) {
  constexpr size_t kBlock = size_t{4} << 20;
  constexpr uint64_t kFieldsBefore = 64;  // size of the record's other fields and lengths
  for (uint64_t start = from; start < file.size(); start += kBlock) {
    const wire::Bytes block = file.read(start, kBlock + kChunkMark.size());
    for (auto mark = block.begin();; ++mark) {
      mark = std::search(mark, block.end(), kChunkMark.begin(), kChunkMark.end());
      if (mark == block.end()) break;
      const uint64_t at = start + static_cast<uint64_t>(mark - block.begin());
      for (uint64_t back = 4; back <= kFieldsBefore && at >= from + back; ++back) {
        const std::optional<RecordView> record = recordIn(file, at - back);
        if (record && record->kind == RecordKind::Chunk && record->fields.number32("size")) return at - back;
      }
    }
  }
  return std::nullopt;
}

class Scan {
 public:
  Scan(ChunkCache* chunks, Diagnostics* diagnostics)
      : chunks_(chunks), file_(chunks->bytes()), diagnostics_(diagnostics) {}

  BagContents run() {
    checkVersion();
    uint64_t position = kVersion.size();
    while (position < file_.size()) {
      const std::optional<RecordView> record = recordIn(file_, position);
      position = record && record->data_size + record->data_offset <= file_.size() - position
                     ? takeRecord(position, *record)
                     : passDamage(position, record);
    }
    finishChunk();
    findConnections();
    reportState();
    return std::move(contents_);
  }

 private:
  using Entries = std::vector<std::pair<uint32_t, BagEntry>>;  ///< with their connections

  void checkVersion() const {
    const wire::Bytes start = file_.read(0, kVersion.size());
    if (std::equal(start.begin(), start.end(), kVersion.begin(), kVersion.end())) return;
    const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
    const std::string name = file_.path().string();
    if (start.empty()) throw InputError(name + ": empty or unreadable; a ROS bag was expected");
    if (text.starts_with("#ROSBAG V") || text.starts_with("#ROSRECORD")) {
      throw InputError(fmt::format("{}: a bag of an old format ({}); convert it with `rosbag fix`", name,
                                   text.substr(0, text.find('\n'))));
    }
    const RecognizedFile recognized = recognizeFile(file_.path());
    if (recognized.kind != FileKind::Ros1Bag) refuseFile(recognized, "a ROS 1 bag begins with #ROSBAG V2.0");
    throw InputError(name + ": no ROS 1 bag (it does not begin with #ROSBAG V2.0)");
  }

  /// Returns the position after the record.
  uint64_t takeRecord(uint64_t position, const RecordView& record) {
    const uint64_t data = position + record.data_offset;
    switch (record.kind) {
      case RecordKind::BagHeader:
        takeBagHeader(record.fields);
        break;
      case RecordKind::Chunk:
        takeChunk(data, record, false);
        break;
      case RecordKind::Index:
        takeIndex(record.fields, file_.read(data, record.data_size));
        break;
      case RecordKind::Connection:
        takeConnection(record.fields, file_.read(data, record.data_size));
        break;
      default:
        break;  // the summary at the end has no further information
    }
    return data + record.data_size;
  }

  void takeBagHeader(const RecordFields& fields) {
    const std::string encryptor = fields.text("encryptor");
    if (!encryptor.empty() && encryptor != "rosbag/NoEncryptor") {
      throw InputError(fmt::format("{}: is encrypted ({}); decrypt it with `rosbag decrypt`",
                                   file_.path().string(), encryptor));
    }
    was_closed_ = fields.number64("index_pos").value_or(0) != 0;
    promised_chunks_ = fields.number32("chunk_count").value_or(0);
  }

  void takeChunk(uint64_t data, const RecordView& record, bool is_cut_off) {
    finishChunk();
    BagChunk chunk;
    chunk.position = data;
    chunk.packed_size = record.data_size;
    chunk.unpacked_size = record.fields.number32("size").value_or(0);
    chunk.compression = record.fields.text("compression");
    chunk.is_cut_off = is_cut_off;
    if (chunk.unpacked_size > kLargeChunk && chunk.unpacked_size / kGreatestRatio > chunk.packed_size) {
      chunk.unpacked_size = chunk.packed_size;  // the number is damaged
    }
    current_ = chunks_->add(chunk);
  }

  void takeIndex(const RecordFields& fields, const wire::Bytes& data) {
    const std::optional<uint32_t> connection = fields.number32("conn");
    const uint32_t count = fields.number32("count").value_or(0);
    if (!current_ || !connection || data.size() < size_t{count} * 12) {
      index_is_damaged_ = true;
      return;
    }
    wire::Reader reader(data);
    for (uint32_t i = 0; i < count; ++i) {
      const Time received = reader.takeTime();
      pending_.emplace_back(*connection, BagEntry{received, *current_, reader.take<uint32_t>()});
    }
  }

  void takeConnection(const RecordFields& fields, const wire::Bytes& data) {
    const std::optional<uint32_t> number = fields.number32("conn");
    const std::optional<RecordFields> description = RecordFields::parse(data);
    if (!number || !description) return;
    contents_.connections[*number] = {fields.text("topic"), description->text("type"),
                                      description->text("md5sum"), description->text("message_definition")};
  }

  /// Skips damaged bytes. `record` may be recognized but incomplete. Returns the position at which to
  /// continue.
  uint64_t passDamage(uint64_t position, const std::optional<RecordView>& record) {
    const std::optional<uint64_t> next = findChunk(file_, position + 1);
    const uint64_t end = next.value_or(file_.size());
    if (record && record->kind == RecordKind::Chunk) {
      RecordView rest = *record;
      rest.data_size = static_cast<uint32_t>(end - std::min(end, position + record->data_offset));
      takeChunk(position + record->data_offset, rest, true);
    } else if (current_) {
      index_is_damaged_ = true;
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

  /// Stores the entries of the chunk's index, or scans the chunk without one.
  void finishChunk() {
    if (!current_) return;
    if (pending_.empty() || index_is_damaged_) {
      pending_.clear();
      lookThrough(*current_);
    }
    for (const auto& [connection, entry] : pending_) contents_.entries[connection].push_back(entry);
    pending_.clear();
    index_is_damaged_ = false;
    current_.reset();
  }

  void lookThrough(uint32_t number) {
    const std::shared_ptr<const Unpacked> unpacked = chunks_->unpack(number);
    const std::span<const uint8_t> bytes(unpacked->bytes);
    size_t offset = 0;
    while (offset < bytes.size()) {
      const std::optional<RecordView> record = recordAt(bytes.subspan(offset));
      if (!record || record->data_size > bytes.size() - offset - record->data_offset) break;
      const std::span<const uint8_t> data = bytes.subspan(offset + record->data_offset, record->data_size);
      const std::optional<uint32_t> connection = record->fields.number32("conn");
      const std::optional<uint64_t> time = record->fields.number64("time");
      if (record->kind == RecordKind::Connection) {
        takeConnection(record->fields, {data.begin(), data.end()});
      } else if (record->kind == RecordKind::Message && connection && time) {
        pending_.emplace_back(*connection, BagEntry{received(*time), number, static_cast<uint32_t>(offset)});
      }
      offset += record->data_offset + record->data_size;
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

  /// Converts a 64-bit field of seconds and nanoseconds, as in messages.
  static Time received(uint64_t seconds_and_nanoseconds) {
    return Time::fromNanoseconds(static_cast<int64_t>(seconds_and_nanoseconds & 0xffffffff) * 1'000'000'000 +
                                 static_cast<int64_t>(seconds_and_nanoseconds >> 32));
  }

  /// Finds connections in bags that were not closed: there, only the chunk of the first message describes
  /// one.
  void findConnections() {
    for (const auto& [connection, entries] : contents_.entries) {
      if (contents_.connections.contains(connection) || entries.empty()) continue;
      pending_.clear();
      lookThrough(entries.front().chunk);
    }
    pending_.clear();
  }

  void reportState() {
    size_t messages = 0;
    Time last;
    for (const auto& [connection, entries] : contents_.entries) {
      messages += entries.size();
      for (const BagEntry& entry : entries) last = std::max(last, entry.received);
    }
    const std::string found =
        fmt::format("{} messages in {} chunks could be recovered, the last received at {} ns", messages,
                    chunks_->count(), last.nanoseconds());
    if (truncated_at_) {
      const std::string promised =
          was_closed_ ? fmt::format("; the bag had {} chunks", promised_chunks_) : std::string();
      diagnostics_->report(Severity::Warning, "bag_truncated",
                           fmt::format("{}: cut off or damaged from byte {} to its end ({}); {}{}",
                                       file_.path().string(), *truncated_at_, file_.size(), found, promised));
    } else if (!was_closed_) {
      diagnostics_->report(
          Severity::Warning, "bag_unindexed",
          fmt::format("{}: was not closed when it was recorded and has no index; {}. What was not written "
                      "to it is lost",
                      file_.path().string(), found));
    } else if (chunks_->count() < promised_chunks_) {
      diagnostics_->report(Severity::Warning, "bag_truncated",
                           fmt::format("{}: cut off at the end of a record; {}; the bag had {} chunks",
                                       file_.path().string(), found, promised_chunks_));
    }
  }

  ChunkCache* chunks_;
  const RandomAccessFile& file_;
  Diagnostics* diagnostics_;
  BagContents contents_;
  std::optional<uint32_t> current_;  ///< last chunk, whose index records follow
  Entries pending_;                  ///< of the current chunk
  bool index_is_damaged_ = false;
  bool was_closed_ = false;
  uint32_t promised_chunks_ = 0;
  std::optional<uint64_t> truncated_at_;
};

}  // namespace

BagContents scanBag(ChunkCache* chunks, Diagnostics* diagnostics) { return Scan(chunks, diagnostics).run(); }

}  // namespace lodeline
