#include "lodeline/node/node_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "lodeline/diagnostics.h"
#include "lodeline/util/edit_distance.h"

namespace lodeline {
namespace {

/// An option and the member that holds its value.
struct Bound {
  const char* name;
  const char* meaning;
  std::variant<bool*, int64_t*, double*, std::string*, std::vector<std::string>*> value;
  bool is_of_ros2 = false;
};

std::vector<Bound> bind(NodeSettings* settings, int64_t* max_images) {
  RunRequest& run = settings->run;
  return {
      {"rig", "file or files that describe the rig", &settings->rig_files},
      {"topics", "topic of a sensor, SENSOR=TOPIC; goes over the rig file", &settings->topics},
      {"qos", "SENSOR=reliable or best_effort, with :DEPTH; the sensor may be 'all'", &settings->qos, true},
      {"output", "folder for the results; none where empty", &run.output},
      {"overwrite", "replace the results of another run in that folder", &run.overwrite},
      {"report", "write report.html at the end", &settings->report},
      {"config", "YAML configuration", &run.config},
      {"set", "one setting, KEY=VALUE; goes over the configuration", &run.overrides},
      {"mag_calibration", "what `lodeline calibrate magnetometer` wrote", &run.magnetometer_calibration},
      {"magnetometer", "off, paper or absolute; by default absolute where it is calibrated",
       &run.magnetometer},
      {"site", "LAT,LON,HEIGHT (degrees, m), for true north", &run.site},
      {"date", "YYYY-MM-DD, for true north", &run.date},
      {"map", "map of earlier dives, in which the run looks for places", &run.map},
      {"map_frame", "name of the map frame", &settings->frames.map},
      {"world_frame", "name of the frame of the odometry", &settings->frames.world},
      {"body_frame", "name of the body frame", &settings->frames.body},
      {"publish_tf", "publish transforms", &settings->publish_tf},
      {"max_images", "images of a camera that may wait", max_images},
      {"patience_s", "how much later than the IMU other readings may come, s", &settings->source.patience_s},
  };
}

void assign(const Bound& option, const OptionValue& value) {
  std::visit(
      [&](auto* member, const auto& given) {
        using Member = std::decay_t<decltype(*member)>;
        using Given = std::decay_t<decltype(given)>;
        if constexpr (std::is_same_v<Member, Given>) {
          *member = given;
        } else if constexpr (std::is_same_v<Member, double> && std::is_same_v<Given, int64_t>) {
          *member = static_cast<double>(given);
        } else if constexpr (std::is_same_v<Member, std::vector<std::string>> &&
                             std::is_same_v<Given, std::string>) {
          *member = given.empty() ? Member() : Member{given};
        } else {
          throw UsageError(
              fmt::format("{}: has a value of the wrong type; it is: {}", option.name, option.meaning));
        }
      },
      option.value, value);
}

/// Name and value of NAME=VALUE.
std::pair<std::string, std::string> splitAssignment(const std::string& option, const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    throw UsageError(fmt::format("{}: '{}' is not of the form SENSOR=VALUE", option, text));
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

SensorQos parseQos(const std::string& text) {
  const size_t colon = std::min(text.find(':'), text.size());
  const std::string word = text.substr(0, colon);
  SensorQos qos;
  qos.is_reliable = word == "reliable";
  bool is_good = qos.is_reliable || word == "best_effort";
  if (colon < text.size()) {
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + colon + 1, end, qos.depth);
    is_good = is_good && error == std::errc() && rest == end && qos.depth > 0;
  }
  if (!is_good) {
    throw UsageError(fmt::format(
        "qos: '{}' is neither 'reliable' nor 'best_effort', with ':' and a positive depth after it", text));
  }
  return qos;
}

}  // namespace

std::map<std::string, std::string> NodeSettings::topicsBySensor() const {
  std::map<std::string, std::string> by_sensor;
  for (const std::string& text : topics)
    by_sensor.insert_or_assign(splitAssignment("topics", text).first, splitAssignment("topics", text).second);
  return by_sensor;
}

SensorQos NodeSettings::qosOf(const std::string& sensor) const {
  SensorQos found;
  for (const std::string& text : qos) {
    const auto [name, value] = splitAssignment("qos", text);
    const SensorQos parsed = parseQos(value);
    if (name == sensor || name == "all") found = parsed;
  }
  return found;
}

NodeSettings readNodeSettings(const OptionValues& values) {
  NodeSettings settings;
  auto max_images = static_cast<int64_t>(settings.source.max_images);
  const std::vector<Bound> options = bind(&settings, &max_images);
  for (const auto& [name, value] : values) {
    const auto known = std::find_if(options.begin(), options.end(), [&, &wanted = name](const Bound& option) {
      return wanted == option.name;
    });
    if (known == options.end()) {
      const auto nearest = std::min_element(
          options.begin(), options.end(), [&, &wanted = name](const Bound& a, const Bound& b) {
            return editDistance(wanted, a.name) < editDistance(wanted, b.name);
          });
      throw UsageError(fmt::format("{}: unknown parameter; did you mean {}?", name, nearest->name));
    }
    assign(*known, value);
  }
  if (settings.rig_files.empty()) {
    throw UsageError(
        "rig: missing; name the file or files that describe the rig (docs/reference/file-formats.md)");
  }
  if (max_images < 1) throw UsageError(fmt::format("max_images: {} is not positive", max_images));
  if (!(settings.source.patience_s > 0.0)) throw UsageError("patience_s: not positive");
  settings.source.max_images = static_cast<size_t>(max_images);
  settings.topicsBySensor();
  settings.qosOf("");  // complains of what cannot be read
  return settings;
}

std::vector<NodeOption> nodeOptions() {
  NodeSettings initial;
  auto max_images = static_cast<int64_t>(initial.source.max_images);
  std::vector<NodeOption> options;
  for (const Bound& option : bind(&initial, &max_images)) {
    const OptionValue value =
        std::visit([](const auto* member) { return OptionValue(*member); }, option.value);
    options.push_back({option.name, option.meaning, value, option.is_of_ros2});
  }
  return options;
}

}  // namespace lodeline
