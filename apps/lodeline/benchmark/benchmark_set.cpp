#include "apps/lodeline/benchmark/benchmark_set.h"

#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "lodeline/diagnostics.h"
#include "lodeline/util/choice.h"

namespace lodeline {
namespace {

struct SetText {
  const char* name;
  const char* yaml;
};

// The files of apps/lodeline/benchmark/sets.
constexpr std::array kSets = {
    SetText{
        "euroc",
#include "euroc.yaml.inc"
    },
    SetText{
        "tumvi",
#include "tumvi.yaml.inc"
    },
    SetText{
        "uzhfpv",
#include "uzhfpv.yaml.inc"
    },
    SetText{
        "hilti22",
#include "hilti22.yaml.inc"
    },
    SetText{
        "tank",
#include "tank.yaml.inc"
    },
    SetText{
        "aqualoc",
#include "aqualoc.yaml.inc"
    },
};

std::string textOr(const YAML::Node& node) { return node.IsDefined() ? node.as<std::string>() : ""; }

template <typename Value>
Value valueOr(const YAML::Node& node, Value fallback = {}) {
  return node.IsDefined() ? node.as<Value>() : fallback;
}

SetTruth truthFrom(const YAML::Node& node) {
  return {textOr(node["file"]), textOr(node["topic"]), textOr(node["frame"]) == "cam0",
          textOr(node["frame_numbers"])};
}

SetLayout layoutFrom(const YAML::Node& node) {
  SetLayout layout;
  layout.data = valueOr<std::vector<std::string>>(node["data"]);
  layout.links = valueOr<std::map<std::string, std::string>>(node["links"]);
  layout.rig = valueOr<std::vector<std::string>>(node["rig"]);
  layout.rig_text = textOr(node["rig_text"]);
  layout.topics = valueOr<std::map<std::string, std::string>>(node["topics"]);
  for (const YAML::Node& truth : node["truth"]) layout.truth.push_back(truthFrom(truth));
  return layout;
}

SetSequence sequenceFrom(const YAML::Node& node) {
  SetSequence sequence;
  for (const auto& entry : node) {
    const auto key = entry.first.as<std::string>();
    if (key == "published") {
      sequence.published_m = entry.second.as<std::map<std::string, double>>();
    } else {
      sequence.words[key] = entry.second.as<std::string>();
    }
  }
  sequence.name = sequence.words.at("name");
  return sequence;
}

BenchmarkSet setFrom(const YAML::Node& root) {
  BenchmarkSet set;
  set.title = root["title"].as<std::string>();
  set.about = root["about"].as<std::string>();
  set.alignment = alignmentTypeFromString(root["align"].as<std::string>());
  if (root["tolerance_s"].IsDefined()) set.tolerance_s = root["tolerance_s"].as<double>();
  for (const YAML::Node& node : root["layouts"]) set.layouts.push_back(layoutFrom(node));
  for (const auto& entry : root["published"]) {
    set.published.push_back({entry.first.as<std::string>(), entry.second.as<std::string>()});
  }
  set.remarks = valueOr<std::vector<std::string>>(root["remarks"]);
  for (const YAML::Node& node : root["sequences"]) set.sequences.push_back(sequenceFrom(node));
  return set;
}

}  // namespace

std::vector<std::string> benchmarkSetNames() {
  std::vector<std::string> names;
  for (const SetText& set : kSets) names.emplace_back(set.name);
  return names;
}

BenchmarkSet benchmarkSet(const std::string& name) {
  for (const SetText& set : kSets) {
    if (name == set.name) return setFrom(YAML::Load(set.yaml));
  }
  throw UsageError(fmt::format("{}: no such set{}; there are euroc, tumvi, uzhfpv, hilti22, tank and aqualoc",
                               name, didYouMean(name, benchmarkSetNames())));
}

}  // namespace lodeline
