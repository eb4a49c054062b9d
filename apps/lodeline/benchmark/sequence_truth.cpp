#include "apps/lodeline/benchmark/sequence_truth.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>

#include "lodeline/evaluation/trajectory/text_table.h"
#include "lodeline/io/euroc/csv_reader.h"
#include "lodeline/io/rosbag/bag_kinds.h"
#include "lodeline/io/rosbag/checked_reading.h"
#include "lodeline/io/rosbag/container/bag_file.h"
#include "lodeline/io/rosbag/messages.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

bool isOfPoses(const BagTopic& topic) {
  const std::string& type = topic.connection.type;
  return type == messages::kPoseStamped.name || type == messages::kOdometry.name;
}

const BagTopic& topicOfPoses(const BagFile& bag, const std::string& name) {
  std::string others;
  for (const BagTopic& topic : bag.topics()) {
    if (!isOfPoses(topic)) continue;
    if (topic.connection.topic == name) return topic;
    others += (others.empty() ? "" : ", ") + topic.connection.topic;
  }
  throw InputError(fmt::format("{}: has no topic {} with the true poses; its topics of poses are {}",
                               bag.file().string(), name, others.empty() ? "none" : others));
}

/// The number at the end of a file name, without extension.
std::optional<int64_t> frameNumber(const std::string& image_name) {
  const std::string stem = fs::path(image_name).stem().string();
  size_t begin = stem.size();
  while (begin > 0 && std::isdigit(static_cast<unsigned char>(stem[begin - 1])) != 0) --begin;
  constexpr size_t kMostDigits = 18;
  if (begin == stem.size() || stem.size() - begin > kMostDigits) return std::nullopt;
  return std::stoll(stem.substr(begin));
}

std::map<int64_t, Time> timesByNumber(const fs::path& image_list, Diagnostics* diagnostics) {
  std::map<int64_t, Time> times;
  CsvReader list(image_list, CsvContent::Images, diagnostics, kCameraRate);
  for (CsvRow row; list.next(&row);) {
    if (const auto number = frameNumber(row.text)) times[*number] = row.time;
  }
  return times;
}

Rigid3 poseOf(const TextTable& table, const TextLine& line) {
  const auto number = [&](size_t column) { return table.number(line, column); };
  const Quat rotation(number(7), number(4), number(5), number(6));
  constexpr double kNormTolerance = 0.01;
  const bool is_rotation = std::abs(rotation.norm() - 1.0) < kNormTolerance;
  const Vec3 translation_m(number(1), number(2), number(3));
  if (!is_rotation || !translation_m.allFinite()) {
    throw InputError(table.where(line) + ": is not a position and a unit quaternion");
  }
  return Rigid3(rotation.normalized(), translation_m);
}

}  // namespace

Trajectory readBagPoses(const fs::path& bag_file, const std::string& name, Diagnostics* diagnostics) {
  const std::unique_ptr<BagFile> bag = openBagFile(bag_file, diagnostics);
  const BagTopic& topic = topicOfPoses(*bag, name);
  const auto parse = topic.connection.type == messages::kOdometry.name ? messages::parseOdometryPose
                                                                       : messages::parsePoseStamped;
  Trajectory trajectory;
  trajectory.name = bag_file.string() + " " + name;
  std::string problem = topic.connection.problem;
  for (const BagEntry& entry : topic.entries) {
    if (!topic.connection.problem.empty()) break;
    const std::optional<wire::Bytes> message = bag->read(topic, entry);
    if (!message) continue;
    if (const auto pose = messages::checkedReading(*message, parse, &problem)) {
      trajectory.poses.push_back({pose->time, pose->world_from_body});
    }
  }
  if (trajectory.empty()) {
    throw InputError(trajectory.name + ": has no pose that can be read" +
                     (problem.empty() ? "" : "; " + problem));
  }
  sortByTime(trajectory, *diagnostics);
  return trajectory;
}

bool hasTopic(const fs::path& bag_file, const std::string& name) {
  Diagnostics ignored;
  const std::unique_ptr<BagFile> bag = openBagFile(bag_file, &ignored);
  return std::any_of(bag->topics().begin(), bag->topics().end(),
                     [&](const BagTopic& topic) { return topic.connection.topic == name; });
}

Trajectory readNumberedPoses(const fs::path& file, const fs::path& image_list, Diagnostics* diagnostics) {
  const std::map<int64_t, Time> times = timesByNumber(image_list, diagnostics);
  const TextTable table = readTextTable(file);
  Trajectory trajectory;
  trajectory.name = file.string();
  for (const TextLine& line : table.lines) {
    constexpr size_t kColumns = 8;
    if (line.fields.size() < kColumns) {
      throw InputError(fmt::format("{}: {} columns where `number x y z qx qy qz qw` has {}",
                                   table.where(line), line.fields.size(), kColumns));
    }
    const double number = table.number(line, 0);
    const auto found = std::abs(number) < 1e15 ? times.find(std::llround(number)) : times.end();
    if (found == times.end()) {
      throw InputError(fmt::format("{}: image {} is not listed in {}", table.where(line), line.fields[0],
                                   image_list.string()));
    }
    trajectory.poses.push_back({found->second, poseOf(table, line)});
  }
  sortByTime(trajectory, *diagnostics);
  return trajectory;
}

Trajectory bodyFromCamera(Trajectory poses, const fs::path& data, const BagArguments& arguments,
                          Diagnostics* diagnostics) {
  const auto source = openRecording(data, {}, arguments, diagnostics);
  const Rigid3 camera_from_body = source->rig().cameras.at(0).body_from_camera.inverse();
  for (StampedPose& pose : poses.poses) pose.world_from_body = pose.world_from_body * camera_from_body;
  return poses;
}

}  // namespace lodeline
