#include "lodeline/output/foxglove/foxglove_file.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include "lodeline/io/rosbag/convert/mcap_file_writer.h"
#include "lodeline/output/foxglove/foxglove_messages.h"
#include "lodeline/output/foxglove/state_messages.h"
#include "lodeline/util/json_text.h"

namespace lodeline::foxglove {
namespace {

constexpr const char *kMap = "map", *kOdom = "odom", *kBody = "base_link", *kRefined = "refined",
                     *kCamera = "camera";

/// Collects the messages of all topics, and writes them in the order of time.
class MessageSheet {
 public:
  explicit MessageSheet(const std::filesystem::path& file) : file_(file, "zstd", "") {}

  uint16_t addTopic(const std::string& topic, const char* schema_name) {
    return addTopic(topic, schema_name, schemaOf(schema_name));
  }
  uint16_t addTopic(const std::string& topic, const char* schema_name, const Json& schema) {
    return file_.addChannel({topic, "json", schema_name, "jsonschema", jsonText(schema, -1)});
  }
  void add(uint16_t topic, Time time, const Json& message) {
    messages_.push_back({time, topic, jsonText(message, -1)});
  }
  void write() {
    std::stable_sort(messages_.begin(), messages_.end(),
                     [](const Message& a, const Message& b) { return a.time < b.time; });
    for (const Message& message : messages_) {
      file_.write(message.topic, message.time,
                  {reinterpret_cast<const uint8_t*>(message.text.data()), message.text.size()});
    }
    file_.close();
  }

 private:
  struct Message {
    Time time;
    uint16_t topic;
    std::string text;
  };

  McapFileWriter file_;
  std::vector<Message> messages_;
};

/// The correction map_from_odom at each stamp for which the run and the map have a pose.
std::vector<std::pair<Time, Rigid3>> corrections(const Run& run) {
  std::vector<std::pair<Time, Rigid3>> corrections;
  auto map = run.map_from_body.begin();
  for (const StampedPose& pose : run.odom_from_body) {
    while (map != run.map_from_body.end() && map->time < pose.time) ++map;
    if (map == run.map_from_body.end()) break;
    if (map->time != pose.time) continue;
    corrections.emplace_back(pose.time, map->world_from_body * pose.world_from_body.inverse());
  }
  return corrections;
}

void addTransforms(const Run& run, MessageSheet* sheet) {
  const uint16_t topic = sheet->addTopic("/tf", kTransform);
  const auto map_from_odom = corrections(run);
  for (const auto& [time, correction] : map_from_odom) {
    sheet->add(topic, time, transformMessage(time, kMap, kOdom, correction));
  }
  for (const StampedPose& pose : run.odom_from_body) {
    sheet->add(topic, pose.time, transformMessage(pose.time, kOdom, kBody, pose.world_from_body));
  }
  if (run.refined_from_body.empty()) return;
  // The batch solution has the world of the run. It does not move with later corrections of the map.
  const Time first = run.odom_from_body.front().time;
  if (map_from_odom.empty()) {
    sheet->add(topic, first, transformMessage(first, kOdom, kRefined, Rigid3()));
  } else {
    sheet->add(topic, first, transformMessage(first, kMap, kRefined, map_from_odom.front().second));
  }
}

void addPaths(const Run& run, MessageSheet* sheet) {
  const uint16_t odometry = sheet->addTopic("/odometry", kPose);
  for (const StampedPose& pose : run.odom_from_body)
    sheet->add(odometry, pose.time, poseMessage(pose, kOdom));
  const Time first = run.odom_from_body.front().time;
  const auto addPath = [&](const char* topic, const std::vector<StampedPose>& poses, const char* frame) {
    if (!poses.empty()) sheet->add(sheet->addTopic(topic, kPoses), first, pathMessage(first, poses, frame));
  };
  addPath("/path/run", run.odom_from_body, kOdom);
  addPath("/path/map", run.map_from_body, kMap);
  addPath("/path/refined", run.refined_from_body, kRefined);
  if (run.landmarks.empty()) return;
  sheet->add(sheet->addTopic("/landmarks", kPointCloud), first,
             landmarksMessage(first, run.landmarks, kOdom));
}

Level levelOf(const std::string& severity) {
  if (severity == "serious") return Level::Error;
  return severity == "warning" ? Level::Warning : Level::Info;
}

/// Findings at the first pose, as run.json has no time of them; and every change of the status.
void addLog(const Run& run, MessageSheet* sheet) {
  const uint16_t topic = sheet->addTopic("/status", kLog);
  const Time first = run.odom_from_body.front().time;
  if (!run.program.empty()) sheet->add(topic, first, logMessage(first, Level::Info, "lodeline", run.program));
  for (const StoredFinding& finding : run.findings) {
    sheet->add(topic, first, logMessage(first, levelOf(finding.severity), finding.kind, finding.message));
  }
  if (!run.states) return;
  const auto statuses = run.states->words.find("status");
  if (statuses == run.states->words.end()) return;
  std::string last;
  for (size_t row = 0; row < run.states->rows(); ++row) {
    const std::string& status = statuses->second[row];
    if (status == last) continue;
    const Time time = Time::fromNanoseconds(run.states->stamp_ns[row]);
    const Level level = status == toString(Status::Tracking) ? Level::Info : Level::Warning;
    sheet->add(topic, time, logMessage(time, level, "status", status));
    last = status;
  }
}

void addStates(const RunTable& table, MessageSheet* sheet) {
  const StateMessages states(table);
  const uint16_t topic = sheet->addTopic("/states", kState, states.schema());
  for (size_t row = 0; row < table.rows(); ++row) {
    sheet->add(topic, Time::fromNanoseconds(table.stamp_ns[row]), states.message(row));
  }
}

void addPictures(const std::vector<StoredPicture>& pictures, MessageSheet* sheet) {
  if (pictures.empty()) return;
  const uint16_t topic = sheet->addTopic("/pictures", kImage);
  for (const StoredPicture& picture : pictures) {
    std::ifstream stream(picture.file, std::ios::binary);
    if (!stream) throw InputError(picture.file.string() + ": cannot be opened");
    const std::vector<uint8_t> bytes{std::istreambuf_iterator<char>(stream), {}};
    sheet->add(topic, picture.time, imageMessage(picture.time, bytes, kCamera));
  }
}

}  // namespace

void writeRun(const Run& run, const std::filesystem::path& file) {
  MessageSheet sheet(file);
  addTransforms(run, &sheet);
  addPaths(run, &sheet);
  addLog(run, &sheet);
  if (run.states) addStates(*run.states, &sheet);
  addPictures(run.pictures, &sheet);
  sheet.write();
}

}  // namespace lodeline::foxglove
