#include "lodeline/io/rosbag/ros2/ros2_bag.h"

#include <fmt/core.h>
#include <zstd.h>

#include "lodeline/io/rosbag/chunks/decompress.h"
#include "lodeline/io/rosbag/ros2/bag_parts.h"
#include "lodeline/io/rosbag/ros2/mcap_record.h"
#include "lodeline/io/rosbag/ros2/mcap_scan.h"
#include "lodeline/util/files/file_kind.h"

namespace lodeline {
namespace {

/// Databases have these numbers as chunks.
constexpr uint32_t kFirstDatabase = uint32_t{1} << 31;
/// Topics of a file have this many numbers.
constexpr uint32_t kTopicsOfFile = 1 << 16;
constexpr uint64_t kLargestMessage = uint64_t{1} << 30;
constexpr uint32_t kZstdMagic = 0xFD2FB528;

/// Unpacks a message that is compressed by itself.
std::optional<wire::Bytes> unpackedMessage(wire::Bytes message) {
  if (message.size() < sizeof(kZstdMagic)) return message;
  if (wire::Reader(message).take<uint32_t>() != kZstdMagic) return message;
  const unsigned long long stated = ZSTD_getFrameContentSize(message.data(), message.size());
  if (stated == ZSTD_CONTENTSIZE_ERROR || (stated != ZSTD_CONTENTSIZE_UNKNOWN && stated > kLargestMessage)) {
    return std::nullopt;
  }
  const bool is_known = stated != ZSTD_CONTENTSIZE_UNKNOWN;
  Unpacked unpacked = unpackChunk("zstd", message, is_known ? stated : kLargestMessage);
  if (is_known && !unpacked.problem.empty()) return std::nullopt;
  return std::move(unpacked.bytes);
}

/// Refuses the topics whose messages are not in CDR by metadata.yaml, whatever their file says.
void refuseFormats(const std::map<std::string, std::string>& formats, BagContents* contents) {
  for (auto& [id, connection] : contents->connections) {
    const auto stated = formats.find(connection.topic);
    if (stated == formats.end() || stated->second == "cdr") continue;
    connection.serialization.reset();
    connection.problem =
        fmt::format("the serialization format '{}' of its messages is not read", stated->second);
  }
}

size_t messagesIn(const BagContents& contents) {
  size_t messages = 0;
  for (const auto& [topic, entries] : contents.entries) messages += entries.size();
  return messages;
}

}  // namespace

Ros2Bag::Ros2Bag(const std::filesystem::path& bag, Diagnostics* diagnostics)
    : BagFile(diagnostics), bag_(bag) {
  const BagParts parts = findBagParts(bag, diagnostics);
  BagContents contents;
  for (const std::filesystem::path& file : parts.files) addPart(file, &contents);
  refuseFormats(parts.formats, &contents);
  const size_t messages = messagesIn(contents);
  if (parts.promised_messages && messages < *parts.promised_messages) {
    diagnostics->report(Severity::Warning, "bag_truncated",
                        fmt::format("{}: {} messages could be recovered; its metadata.yaml states {}",
                                    bag.string(), messages, *parts.promised_messages));
  }
  setTopics(std::move(contents));
}

void Ros2Bag::addPart(const std::filesystem::path& file, BagContents* contents) {
  const auto first_topic = static_cast<uint32_t>(files_.size()) * kTopicsOfFile;
  if (files_.size() >= kTopicsOfFile) throw InputError(bag_.string() + ": has too many files");
  const UnpackedFile& part = files_.emplace_back(file);
  if (part.isCutOff()) {
    diagnostics_->report(Severity::Warning, "bag_truncated",
                         fmt::format("{}: its zstd data ends too early; the rest is lost", file.string()));
  }
  const RecognizedFile recognized = recognizeFile(part.path());
  if (recognized.kind == FileKind::Mcap) {
    scanMcap(chunks_.addFile(part.path()), first_topic, &chunks_, contents, diagnostics_);
  } else if (recognized.kind == FileKind::Ros2Bag) {
    const auto number = kFirstDatabase + static_cast<uint32_t>(databases_.size());
    databases_.emplace_back(part.path(), file.string(), diagnostics_).scan(number, first_topic, contents);
  } else {
    refuseFile({file, recognized.kind, recognized.what, recognized.advice},
               "a ROS 2 bag is a SQLite database or an MCAP file");
  }
}

std::optional<wire::Bytes> Ros2Bag::stored(const BagEntry& entry) {
  std::optional<wire::Bytes> message = entry.chunk >= kFirstDatabase
                                           ? databases_[entry.chunk - kFirstDatabase].read(entry.offset)
                                           : fromChunk(entry);
  if (message) message = unpackedMessage(std::move(*message));
  if (!message) reportLoss(entry);
  return message;
}

std::optional<wire::Bytes> Ros2Bag::fromChunk(const BagEntry& entry) {
  constexpr size_t kBefore = mcap::kRecordHead + mcap::kMessageFields;
  wire::Bytes bytes = chunks_.read(entry.chunk, entry.offset, kMessageAtOnce);
  const std::optional<mcap::RecordHead> head = mcap::recordHead(bytes);
  if (!head || head->kind != mcap::Kind::Message || head->size < mcap::kMessageFields ||
      head->size > kLargestMessage || bytes.size() < kBefore) {
    return std::nullopt;
  }
  const size_t size = head->size - mcap::kMessageFields;
  if (kBefore + size <= bytes.size()) {
    const auto first = bytes.begin() + kBefore;
    return wire::Bytes(first, first + static_cast<std::ptrdiff_t>(size));
  }
  bytes = chunks_.read(entry.chunk, entry.offset + kBefore, size);
  if (bytes.size() != size) return std::nullopt;
  return bytes;
}

void Ros2Bag::reportLoss(const BagEntry& entry) {
  if (entry.chunk >= kFirstDatabase) {
    diagnostics_->report(Severity::Warning, "bag_damaged",
                         fmt::format("{}: the message in row {}, recorded at {} ns, is damaged; it is lost",
                                     bag_.string(), entry.offset, entry.received.nanoseconds()));
    return;
  }
  const BagChunk& chunk = chunks_.chunk(entry.chunk);
  const std::string reason = chunk.compression == "none" ? "" : chunks_.unpack(entry.chunk)->problem;
  diagnostics_->report(
      Severity::Warning, "bag_chunk",
      fmt::format("{}: the chunk at byte {}: {}; messages from {} ns on are lost",
                  chunks_.bytes(chunk.file).path().string(), chunk.position,
                  reason.empty() ? "its records are damaged" : reason, entry.received.nanoseconds()));
}

}  // namespace lodeline
