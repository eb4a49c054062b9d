#include "lodeline/io/rosbag/convert/mcap_writer.h"

#include <fmt/core.h>
#include <libdeflate.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/ros2/mcap_record.h"

namespace lodeline {
namespace {

using mcap::Kind;

/// A chunk is written when it has this many bytes.
constexpr size_t kChunkBytes = size_t{4} << 20;
constexpr int kZstdLevel = 1;

uint64_t number(Time time) { return static_cast<uint64_t>(time.nanoseconds()); }

wire::Bytes record(Kind kind, const wire::Bytes& content) {
  wire::Writer writer;
  writer.put(static_cast<uint8_t>(kind));
  writer.put(uint64_t{content.size()});
  wire::Bytes bytes = writer.take();
  bytes.insert(bytes.end(), content.begin(), content.end());
  return bytes;
}

wire::Bytes schemaRecord(const WrittenTopic& topic) {
  wire::Writer content;
  content.put(topic.number);
  content.putText(topic.type);
  content.putText("ros2msg");
  content.putText(topic.definition);
  return record(Kind::Schema, content.take());
}

wire::Bytes channelRecord(const WrittenTopic& topic) {
  wire::Writer metadata;
  metadata.putText("offered_qos_profiles");
  metadata.putText("");
  wire::Writer content;
  content.put(topic.number);
  content.put(topic.number);  // its schema
  content.putText(topic.name);
  content.putText("cdr");
  content.putSized(metadata.take());
  return record(Kind::Channel, content.take());
}

wire::Bytes pack(const wire::Bytes& bytes, const std::string& compression) {
  if (compression == "none") return bytes;
  wire::Bytes packed;
  if (compression == "zstd") {
    packed.resize(ZSTD_compressBound(bytes.size()));
    packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kZstdLevel));
  } else {
    packed.resize(LZ4F_compressFrameBound(bytes.size(), nullptr));
    packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr));
  }
  return packed;
}

void append(const wire::Bytes& bytes, wire::Bytes* to) { to->insert(to->end(), bytes.begin(), bytes.end()); }

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& file, std::string compression,
                       std::filesystem::path metadata)
    : file_(file),
      metadata_(std::move(metadata)),
      compression_(std::move(compression)),
      stream_(file, std::ios::binary | std::ios::trunc) {
  put({mcap::kMagic.begin(), mcap::kMagic.end()});
  wire::Writer header;
  header.putText("ros2");
  header.putText("lodeline");
  put(record(Kind::Header, header.take()));
}

void McapWriter::put(const wire::Bytes& bytes) {
  stream_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!stream_) {
    throw InputError(file_.string() + ": cannot be written; is there space and permission?");
  }
  position_ += bytes.size();
}

void McapWriter::write(const std::string& topic, const std::string& type, Time received,
                       wire::Bytes message) {
  const auto [written, is_new] = messages_.topic(topic, type, "", received);
  add(written, is_new, received, messages_.toCdr(type, message));
}

void McapWriter::writeStored(const BagConnection& connection, Time received, wire::Bytes message) {
  const auto [written, is_new] =
      messages_.topic(connection.topic, connection.type, connection.definition, received);
  add(written, is_new, received, message);
}

void McapWriter::add(WrittenTopic* topic, bool is_new, Time received, const wire::Bytes& message) {
  if (is_new) {
    append(schemaRecord(*topic), &chunk_);
    append(channelRecord(*topic), &chunk_);
  }
  chunk_first_ = index_.empty() ? received : std::min(chunk_first_, received);
  chunk_last_ = index_.empty() ? received : std::max(chunk_last_, received);
  index_[topic->number].emplace_back(received, chunk_.size());
  wire::Writer head;
  head.put(static_cast<uint8_t>(Kind::Message));
  head.put(uint64_t{mcap::kMessageFields + message.size()});
  head.put(topic->number);
  head.put(static_cast<uint32_t>(topic->messages - 1));
  head.put(number(received));  // recorded
  head.put(number(received));  // published
  append(head.take(), &chunk_);
  append(message, &chunk_);
  if (chunk_.size() >= kChunkBytes) finishChunk();
}

void McapWriter::finishChunk() {
  if (index_.empty()) return;
  const wire::Bytes packed = pack(chunk_, compression_);
  WrittenChunk written{chunk_first_, chunk_last_, position_, 0, {}, 0, packed.size(), chunk_.size()};
  wire::Writer fields;
  fields.put(number(chunk_first_));
  fields.put(number(chunk_last_));
  fields.put(uint64_t{chunk_.size()});
  fields.put(libdeflate_crc32(0, chunk_.data(), chunk_.size()));
  fields.putText(compression_ == "none" ? "" : compression_);
  fields.put(uint64_t{packed.size()});
  wire::Bytes content = fields.take();
  append(packed, &content);
  put(record(Kind::Chunk, content));
  written.size = position_ - written.position;
  const uint64_t indexes = position_;
  for (const auto& [channel, entries] : index_) {
    wire::Writer list;
    for (const auto& [time, offset] : entries) {
      list.put(number(time));
      list.put(offset);
    }
    wire::Writer index;
    index.put(channel);
    index.putSized(list.take());
    written.indexes[channel] = position_;
    put(record(Kind::MessageIndex, index.take()));
  }
  written.indexes_size = position_ - indexes;
  chunks_.push_back(std::move(written));
  chunk_.clear();
  index_.clear();
}

void McapWriter::close() {
  finishChunk();
  wire::Writer end;
  end.put(uint32_t{0});  // no checksum of the data
  put(record(Kind::DataEnd, end.take()));
  writeSummary();
  put({mcap::kMagic.begin(), mcap::kMagic.end()});
  stream_.close();
  if (!stream_) throw InputError(file_.string() + ": could not be written in full; is the disk full?");
  if (metadata_.empty()) return;
  std::ofstream metadata(metadata_);
  metadata << metadataText(messages_, file_.filename().string(), "mcap");
  metadata.close();
  if (!metadata) throw InputError(metadata_.string() + ": could not be written");
}

void McapWriter::writeSummary() {
  const uint64_t start = position_;
  wire::Bytes summary, offsets;
  const auto addGroup = [&](Kind kind, const wire::Bytes& records) {
    if (records.empty()) return;
    wire::Writer offset;
    offset.put(static_cast<uint8_t>(kind));
    offset.put(start + summary.size());
    offset.put(uint64_t{records.size()});
    append(record(Kind::SummaryOffset, offset.take()), &offsets);
    append(records, &summary);
  };
  wire::Bytes schemas, channels, chunk_indexes;
  wire::Writer counts;
  for (const auto& [name, topic] : messages_.topics()) {
    append(schemaRecord(topic), &schemas);
    append(channelRecord(topic), &channels);
    counts.put(topic.number);
    counts.put(topic.messages);
  }
  wire::Writer statistics;
  statistics.put(messages_.messages());
  statistics.put(static_cast<uint16_t>(messages_.topics().size()));
  statistics.put(static_cast<uint32_t>(messages_.topics().size()));
  statistics.put(uint32_t{0});  // attachments
  statistics.put(uint32_t{0});  // metadata
  statistics.put(static_cast<uint32_t>(chunks_.size()));
  statistics.put(number(messages_.first()));
  statistics.put(number(messages_.last()));
  statistics.putSized(counts.take());
  for (const WrittenChunk& chunk : chunks_) {
    wire::Writer positions;
    for (const auto& [channel, position] : chunk.indexes) {
      positions.put(channel);
      positions.put(position);
    }
    wire::Writer index;
    for (const uint64_t value : {number(chunk.first), number(chunk.last), chunk.position, chunk.size}) {
      index.put(value);
    }
    index.putSized(positions.take());
    index.put(chunk.indexes_size);
    index.putText(compression_ == "none" ? "" : compression_);
    index.put(chunk.packed_size);
    index.put(chunk.unpacked_size);
    append(record(Kind::ChunkIndex, index.take()), &chunk_indexes);
  }
  addGroup(Kind::Schema, schemas);
  addGroup(Kind::Channel, channels);
  addGroup(Kind::Statistics, record(Kind::Statistics, statistics.take()));
  addGroup(Kind::ChunkIndex, chunk_indexes);
  wire::Writer footer;
  footer.put(start);
  footer.put(start + summary.size());
  footer.put(uint32_t{0});  // place of the checksum
  append(offsets, &summary);
  append(record(Kind::Footer, footer.take()), &summary);
  // The checksum covers the summary up to itself.
  const size_t covered = summary.size() - sizeof(uint32_t);
  const uint32_t checksum = libdeflate_crc32(0, summary.data(), covered);
  std::memcpy(summary.data() + covered, &checksum, sizeof(checksum));
  put(summary);
}

}  // namespace lodeline
