#include "lodeline/io/rosbag/convert/mcap_writer.h"

#include "lodeline/diagnostics.h"

namespace lodeline {

McapWriter::McapWriter(const std::filesystem::path& file, std::string compression,
                       std::filesystem::path metadata)
    : file_name_(file.filename().string()),
      metadata_(std::move(metadata)),
      file_(file, std::move(compression), "ros2") {}

void McapWriter::write(const std::string& topic, const std::string& type, Time received,
                       wire::Bytes message) {
  const auto [written, is_new] = messages_.topic(topic, type, "", received);
  add(*written, is_new, received, messages_.toCdr(type, message));
}

void McapWriter::writeStored(const BagConnection& connection, Time received, wire::Bytes message) {
  const auto [written, is_new] =
      messages_.topic(connection.topic, connection.type, connection.definition, received);
  add(*written, is_new, received, message);
}

void McapWriter::add(const WrittenTopic& topic, bool is_new, Time received, const wire::Bytes& message) {
  if (is_new) {
    // Topics and channels are numbered alike, from 1 on in the order of their first messages.
    file_.addChannel(
        {topic.name, "cdr", topic.type, "ros2msg", topic.definition, {{"offered_qos_profiles", ""}}});
  }
  file_.write(topic.number, received, message);
}

void McapWriter::close() {
  file_.close();
  if (metadata_.empty()) return;
  std::ofstream metadata(metadata_);
  metadata << metadataText(messages_, file_name_, "mcap");
  metadata.close();
  if (!metadata) throw InputError(metadata_.string() + ": could not be written");
}

}  // namespace lodeline
