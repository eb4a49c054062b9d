#include "lodeline/io/rosbag/convert/mcap_file_writer.h"

#include <libdeflate.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <tuple>

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

wire::Bytes schemaRecord(uint16_t number, const McapChannel& channel) {
  wire::Writer content;
  content.put(number);
  content.putText(channel.schema_name);
  content.putText(channel.schema_encoding);
  content.putText(channel.schema);
  return record(Kind::Schema, content.take());
}

wire::Bytes channelRecord(uint16_t number, const McapChannel& channel) {
  wire::Writer metadata;
  for (const auto& [key, value] : channel.metadata) {
    metadata.putText(key);
    metadata.putText(value);
  }
  wire::Writer content;
  content.put(number);
  content.put(number);  // its schema
  content.putText(channel.topic);
  content.putText(channel.message_encoding);
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

void append(std::span<const uint8_t> bytes, wire::Bytes* to) {
  to->insert(to->end(), bytes.begin(), bytes.end());
}

}  // namespace

McapFileWriter::McapFileWriter(const std::filesystem::path& file, std::string compression,
                               const std::string& profile)
    : file_(file), compression_(std::move(compression)), stream_(file, std::ios::binary | std::ios::trunc) {
  put({mcap::kMagic.begin(), mcap::kMagic.end()});
  wire::Writer header;
  header.putText(profile);
  header.putText("lodeline");
  put(record(Kind::Header, header.take()));
}

void McapFileWriter::put(const wire::Bytes& bytes) {
  stream_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!stream_) {
    throw InputError(file_.string() + ": cannot be written; is there space and permission?");
  }
  position_ += bytes.size();
}

uint16_t McapFileWriter::addChannel(McapChannel channel) {
  if (channels_.size() >= std::numeric_limits<uint16_t>::max()) {
    throw InputError(file_.string() + ": too many topics for an MCAP file");
  }
  const auto number = static_cast<uint16_t>(channels_.size() + 1);
  append(schemaRecord(number, channel), &chunk_);
  append(channelRecord(number, channel), &chunk_);
  channels_.push_back({std::move(channel), 0});
  return number;
}

void McapFileWriter::write(uint16_t channel, Time time, std::span<const uint8_t> message) {
  chunk_first_ = index_.empty() ? time : std::min(chunk_first_, time);
  chunk_last_ = index_.empty() ? time : std::max(chunk_last_, time);
  index_[channel].emplace_back(time, chunk_.size());
  wire::Writer head;
  head.put(static_cast<uint8_t>(Kind::Message));
  head.put(uint64_t{mcap::kMessageFields + message.size()});
  head.put(channel);
  head.put(static_cast<uint32_t>(channels_[channel - size_t{1}].messages++));
  head.put(number(time));  // recorded
  head.put(number(time));  // published
  append(head.take(), &chunk_);
  append(message, &chunk_);
  if (chunk_.size() >= kChunkBytes) finishChunk();
}

void McapFileWriter::finishChunk() {
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

void McapFileWriter::close() {
  finishChunk();
  wire::Writer end;
  end.put(uint32_t{0});  // no checksum of the data
  put(record(Kind::DataEnd, end.take()));
  writeSummary();
  put({mcap::kMagic.begin(), mcap::kMagic.end()});
  stream_.close();
  if (!stream_) throw InputError(file_.string() + ": could not be written in full; is the disk full?");
}

std::vector<uint16_t> McapFileWriter::channelsByName() const {
  std::vector<uint16_t> numbers(channels_.size());
  std::iota(numbers.begin(), numbers.end(), uint16_t{1});
  const auto name = [this](uint16_t number) {
    const McapChannel& channel = channels_[number - size_t{1}].channel;
    return std::tie(channel.topic, channel.schema_name);
  };
  std::stable_sort(numbers.begin(), numbers.end(), [&](uint16_t a, uint16_t b) { return name(a) < name(b); });
  return numbers;
}

void McapFileWriter::writeSummary() {
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
  uint64_t messages = 0;
  for (const uint16_t number : channelsByName()) {
    const WrittenChannel& written = channels_[number - size_t{1}];
    append(schemaRecord(number, written.channel), &schemas);
    append(channelRecord(number, written.channel), &channels);
    counts.put(number);
    counts.put(written.messages);
    messages += written.messages;
  }
  wire::Writer statistics;
  statistics.put(messages);
  statistics.put(static_cast<uint16_t>(channels_.size()));  // schemas
  statistics.put(static_cast<uint32_t>(channels_.size()));
  statistics.put(uint32_t{0});  // attachments
  statistics.put(uint32_t{0});  // metadata
  statistics.put(static_cast<uint32_t>(chunks_.size()));
  Time first, last;
  for (const WrittenChunk& chunk : chunks_) {
    const bool is_first = &chunk == &chunks_.front();
    first = is_first ? chunk.first : std::min(first, chunk.first);
    last = is_first ? chunk.last : std::max(last, chunk.last);
  }
  statistics.put(number(first));
  statistics.put(number(last));
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
