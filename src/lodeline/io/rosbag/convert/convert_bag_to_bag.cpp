#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <set>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/rosbag/bag_kinds.h"
#include "lodeline/io/rosbag/bag_source.h"
#include "lodeline/io/rosbag/convert/bag_writer.h"
#include "lodeline/io/rosbag/convert/convert.h"
#include "lodeline/io/rosbag/convert/rig_conversion.h"
#include "lodeline/io/rosbag/definitions/known_definitions.h"
#include "lodeline/io/rosbag/topic_choice.h"

namespace lodeline {
namespace {

/// A topic that is copied.
struct Copied {
  const BagTopic* topic;
  bool is_stored = false;  ///< whether the stored bytes are copied
  size_t next = 0;
};

/// Topics of images that do not belong to the chosen cameras; none where all cameras are converted.
std::set<const BagTopic*> topicsOfOtherImages(BagFile* bag, const std::optional<RigFile>& rig,
                                              const ConvertOptions& options) {
  if (options.cameras.empty()) return {};
  TopicWish wish;
  if (rig) wish.named = rig->topics;
  for (const auto& [sensor, topic] : options.topics) wish.named[sensor] = topic;
  std::erase_if(wish.named, [](const auto& entry) { return !entry.first.starts_with("cam"); });
  const bool has_cameras = rig && !rig->rig.cameras.empty();
  const size_t count = has_cameras ? rig->rig.cameras.size() : imageTopics(*bag).size();
  for (size_t i = 0; i < count; ++i) wish.rig_cameras.push_back(fmt::format("cam{}", i));
  for (const int camera : options.cameras) {
    if (static_cast<size_t>(camera) >= count)
      throw InputError(fmt::format("{}: has no camera {}; it has {}", bag->file().string(), camera, count));
    wish.cameras.push_back(fmt::format("cam{}", camera));
  }
  Diagnostics of_the_choice;  // other sensors are copied without being chosen
  const TopicChoice choice = chooseTopics(bag, wish, &of_the_choice);
  const std::vector<const BagTopic*> images = topicsFor(*bag, "cam0");
  std::set<const BagTopic*> others(images.begin(), images.end());
  for (const std::string& camera : wish.cameras) others.erase(choice.of(camera));
  return others;
}

std::vector<Copied> topicsToCopy(const BagFile& bag, const BagWriter& writer,
                                 const std::set<const BagTopic*>& left_out, Diagnostics* diagnostics) {
  std::vector<Copied> copied;
  for (const BagTopic& topic : bag.topics()) {
    if (left_out.contains(&topic)) continue;
    const BagConnection& connection = topic.connection;
    const bool is_stored = writer.takesStored(connection);
    const bool is_known =
        !connection.md5sum.empty() && connection.md5sum == definitions::ros1Checksum(connection.type);
    if (is_stored || is_known) {
      copied.push_back({&topic, is_stored, 0});
      continue;
    }
    diagnostics->report(
        Severity::Warning, "convert_left_out",
        fmt::format("{}: topic {} ({}, {} messages) is left out: its type cannot be carried "
                    "over to the other format",
                    bag.file().string(), connection.topic, connection.type, topic.entries.size()));
  }
  return copied;
}

/// Copies all messages in the order of the times at which they were recorded.
void copyMessages(BagFile* bag, std::vector<Copied> topics, const ConvertOptions& options, BagWriter* writer,
                  ConvertSummary* summary) {
  size_t all = 0, done = 0;
  std::optional<Time> start;
  for (const Copied& topic : topics) {
    all += topic.topic->entries.size();
    for (const BagEntry& entry : topic.topic->entries)
      start = std::min(start.value_or(entry.received), entry.received);
  }
  while (true) {
    Copied* first = nullptr;
    for (Copied& topic : topics) {
      if (topic.next == topic.topic->entries.size()) continue;
      if (first != nullptr &&
          first->topic->entries[first->next].received <= topic.topic->entries[topic.next].received) {
        continue;
      }
      first = &topic;
    }
    if (first == nullptr) return;
    options.progress(static_cast<double>(done++) / static_cast<double>(all));
    const BagConnection& connection = first->topic->connection;
    const BagEntry& entry = first->topic->entries[first->next++];
    if (!options.part.isAll() && !options.part.contains(*start, entry.received)) continue;
    std::optional<wire::Bytes> message =
        first->is_stored ? bag->stored(entry) : bag->read(*first->topic, entry);
    if (!message) continue;
    if (first->is_stored) {
      writer->writeStored(connection, entry.received, std::move(*message));
    } else {
      writer->write(connection.topic, connection.type, entry.received, std::move(*message));
    }
    ++summary->readings[connection.topic];
  }
}

/// The rig files of the bag: given, or beside it.
std::vector<std::filesystem::path> rigFilesOf(const std::filesystem::path& bag,
                                              const ConvertOptions& options) {
  if (!options.rig_files.empty()) return options.rig_files;
  const std::filesystem::path beside = rigFileBeside(bag);
  if (std::filesystem::exists(beside)) return {beside};
  return {};
}

}  // namespace

ConvertSummary convertBagToBag(const std::filesystem::path& bag, const std::filesystem::path& target,
                               const ConvertOptions& options, Diagnostics* diagnostics) {
  requireAbsent(target);
  const std::vector<std::filesystem::path> rig_files = rigFilesOf(bag, options);
  std::optional<RigFile> rig;
  if (!rig_files.empty()) rig = readRigFiles(rig_files, diagnostics);
  const std::unique_ptr<BagFile> source = openBagFile(bag, diagnostics);
  const std::set<const BagTopic*> left_out = topicsOfOtherImages(source.get(), rig, options);
  const std::unique_ptr<BagWriter> writer = makeBagWriter(target, options.format, options.compression);
  ConvertSummary summary;
  copyMessages(source.get(), topicsToCopy(*source, *writer, left_out, diagnostics), options, writer.get(),
               &summary);
  writer->close();
  if (rig) {
    summary.rig_file = rigFileBeside(target);
    for (const auto& [sensor, topic] : options.topics) rig->topics[sensor] = topic;
    writeRigFile(numberedRig(*rig, options.cameras), {}, summary.rig_file);
  } else {
    diagnostics->report(Severity::Warning, "calibration_missing",
                        fmt::format("{}: written without calibration, which `lodeline run` needs; describe "
                                    "the rig with --rig FILE",
                                    target.string()));
  }
  return summary;
}

}  // namespace lodeline
