#include "lodeline_ros/node_parameters.h"

#include <fmt/core.h>
#include <ros/param.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/util/edit_distance.h"

namespace lodeline {
namespace {

/// Reads parameters one by one and records the requested names.
class Reader {
 public:
  explicit Reader(const ros::NodeHandle& node) : node_(node) {}

  template <typename Value>
  void read(const char* name, Value* value) {
    known_.emplace_back(name);
    if (node_.hasParam(name) && !node_.getParam(name, *value)) {
      throw UsageError(
          fmt::format("~{}: has a value of the wrong type (see docs/reference/ros-node.md)", name));
    }
  }

  /// A text or a list of texts.
  std::vector<std::string> readList(const char* name) {
    known_.emplace_back(name);
    std::vector<std::string> list;
    std::string one;
    if (node_.getParam(name, one)) return {one};
    if (node_.hasParam(name) && !node_.getParam(name, list)) {
      throw UsageError(fmt::format("~{}: neither a text nor a list of texts", name));
    }
    return list;
  }

  /// Throws for the first parameter that was not requested.
  void refuseOthers() const {
    const std::string prefix = node_.getNamespace() + "/";
    std::vector<std::string> names;
    ros::param::getParamNames(names);
    for (const std::string& name : names) {
      if (!name.starts_with(prefix)) continue;
      std::string own = name.substr(prefix.size());
      own.erase(std::min(own.find('/'), own.size()));
      if (std::find(known_.begin(), known_.end(), own) != known_.end()) continue;
      const auto nearest = std::min_element(known_.begin(), known_.end(), [&](const auto& a, const auto& b) {
        return editDistance(own, a) < editDistance(own, b);
      });
      throw UsageError(
          fmt::format("~{}: unknown parameter; did you mean ~{}? (The master keeps parameters of older runs: "
                      "rosparam delete {})",
                      own, *nearest, prefix + own));
    }
  }

 private:
  const ros::NodeHandle& node_;
  std::vector<std::string> known_;
};

}  // namespace

NodeParameters readNodeParameters(const ros::NodeHandle& node) {
  NodeParameters parameters;
  Reader reader(node);
  for (const std::string& file : reader.readList("rig")) parameters.rig_files.emplace_back(file);
  reader.read("topics", &parameters.topics);
  RunRequest& run = parameters.run;
  reader.read("output", &run.output);
  reader.read("config", &run.config);
  run.overrides = reader.readList("set");
  reader.read("mag_calibration", &run.magnetometer_calibration);
  reader.read("magnetometer", &run.magnetometer);
  reader.read("site", &run.site);
  reader.read("date", &run.date);
  reader.read("map", &run.map);
  reader.read("map_frame", &parameters.frames.map);
  reader.read("world_frame", &parameters.frames.world);
  reader.read("body_frame", &parameters.frames.body);
  reader.read("publish_tf", &parameters.publish_tf);
  reader.read("report", &parameters.report);
  int max_images = static_cast<int>(parameters.source.max_images);
  reader.read("max_images", &max_images);
  reader.read("patience_s", &parameters.source.patience_s);
  reader.refuseOthers();
  if (parameters.rig_files.empty()) {
    throw UsageError(
        "~rig: missing; name the file or files that describe the rig (docs/reference/file-formats.md)");
  }
  if (max_images < 1) throw UsageError(fmt::format("~max_images: {} is not positive", max_images));
  if (!(parameters.source.patience_s > 0.0)) throw UsageError("~patience_s: not positive");
  parameters.source.max_images = static_cast<size_t>(max_images);
  return parameters;
}

}  // namespace lodeline
