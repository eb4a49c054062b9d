#include "apps/lodeline/survey/survey_project.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <functional>
#include <map>

#include "lodeline/diagnostics.h"
#include "lodeline/util/choice.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

/// Reads the keys of one mapping of a file.
class Keys {
 public:
  using Use = std::function<void(const YAML::Node&)>;

  explicit Keys(fs::path file) : file_(std::move(file)) {}

  void on(const std::string& key, Use use) { uses_[key] = std::move(use); }
  void text(const std::string& key, std::string* target) {
    on(key, [target](const YAML::Node& node) { *target = node.as<std::string>(); });
  }
  void path(const std::string& key, fs::path* target) {
    on(key, [this, target](const YAML::Node& node) { *target = pathOf(node); });
  }
  void number(const std::string& key, std::function<void(double)> use) {
    on(key, [use = std::move(use)](const YAML::Node& node) {
      const double value = node.as<double>();
      if (!std::isfinite(value)) throw YAML::Exception(node.Mark(), "a finite number is wanted");
      use(value);
    });
  }
  /// One text or a list of them.
  void texts(const std::string& key, std::vector<std::string>* target) {
    on(key, [target](const YAML::Node& node) {
      if (node.IsScalar()) target->push_back(node.as<std::string>());
      if (node.IsSequence()) *target = node.as<std::vector<std::string>>();
    });
  }
  void numbers(const std::string& key, size_t count, std::function<void(const std::vector<double>&)> use) {
    on(key, [count, use = std::move(use)](const YAML::Node& node) {
      const auto values = node.as<std::vector<double>>();
      for (double value : values) {
        if (!std::isfinite(value)) throw YAML::Exception(node.Mark(), "finite numbers are wanted");
      }
      if (values.size() != count)
        throw YAML::Exception(node.Mark(), fmt::format("a list of {} numbers is wanted", count));
      use(values);
    });
  }

  fs::path pathOf(const YAML::Node& node) const {
    return (file_.parent_path() / node.as<std::string>()).lexically_normal();
  }

  void read(const YAML::Node& node) const {
    if (!node.IsMap()) fail(node.Mark(), "names and values are wanted");
    for (const auto& entry : node) {
      const auto key = entry.first.as<std::string>();
      const auto use = uses_.find(key);
      if (use == uses_.end()) {
        std::vector<std::string> known;
        for (const auto& [name, ignored] : uses_) known.push_back(name);
        fail(entry.first.Mark(),
             fmt::format("unknown key '{}'; the keys are {}", key, fmt::join(known, ", ")));
      }
      try {
        use->second(entry.second);
      } catch (const YAML::Exception& error) {
        fail(entry.second.Mark(), fmt::format("{}: {}", key, error.msg));
      }
    }
  }

  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& why) const {
    throw InputError(fmt::format("{}:{}: {}", file_.string(), mark.line + 1, why));
  }

 private:
  fs::path file_;
  std::map<std::string, Use> uses_;
};

ProjectDive readDive(const fs::path& file, const YAML::Node& node) {
  ProjectDive dive;
  Keys keys(file);
  keys.path("run", &dive.run);
  keys.path("recording", &dive.recording);
  keys.on("rig", [&](const YAML::Node& value) {
    if (value.IsScalar()) dive.rig.push_back(keys.pathOf(value).string());
    for (const YAML::Node& one : value) dive.rig.push_back(keys.pathOf(one).string());
  });
  keys.text("dive", &dive.dive);
  keys.text("name", &dive.name);
  keys.text("title", &dive.title);
  keys.text("date", &dive.date);
  keys.texts("team", &dive.team);
  keys.numbers("start", 3, [&](const std::vector<double>& v) { dive.start_ENU = Vec3(v[0], v[1], v[2]); });
  keys.numbers("start_sigma", 2, [&](const std::vector<double>& v) {
    dive.start_sigma_m = v[0];
    dive.start_sigma_up_m = v[1];
  });
  keys.read(node);
  if (dive.run.empty() && dive.dive.empty()) keys.fail(node.Mark(), "a dive wants 'run' or 'dive'");
  if (!dive.recording.empty() && dive.run.empty())
    keys.fail(node.Mark(), "the 'recording' of a dive wants its 'run', whose poses place the echoes");
  if (dive.dive.empty()) {
    const fs::path folder = dive.run.has_filename() ? dive.run : dive.run.parent_path();
    dive.dive = folder.filename().string();
  }
  return dive;
}

YAML::Node loadYaml(const fs::path& file) {
  try {
    return YAML::LoadFile(file.string());
  } catch (const YAML::BadFile&) {
    throw InputError(file.string() + ": cannot be read");
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("{}:{}: {}", file.string(), error.mark.line + 1, error.msg));
  }
}

}  // namespace

const ProjectDive* SurveyProject::find(const std::string& dive) const {
  for (const ProjectDive& row : dives) {
    if (row.dive == dive) return &row;
  }
  return nullptr;
}

SurveyProject readSurveyProject(const fs::path& file) {
  SurveyProject project;
  const YAML::Node node = loadYaml(file);
  Keys keys(file);
  keys.path("map", &project.map);
  keys.on("control", [&](const YAML::Node& value) {
    if (value.IsScalar()) project.control.push_back(keys.pathOf(value));
    for (const YAML::Node& one : value) project.control.push_back(keys.pathOf(one));
  });
  keys.text("name", &project.name);
  keys.text("title", &project.title);
  keys.text("date", &project.date);
  keys.texts("team", &project.team);
  keys.text("entrance", &project.entrance);
  keys.numbers("entrance_sigma", 2, [&](const std::vector<double>& v) { project.entrance_sigma_m = v; });
  keys.text("crs", &project.crs);
  keys.text("vertical_datum", &project.vertical_datum);
  keys.number("geoid_height", [&](double v) { project.geoid_height_m = v; });
  keys.number("turn", [&](double v) { project.turn_deg = v; });
  keys.number("merge", [&](double v) { project.merge_m = v; });
  keys.number("spacing", [&](double v) { project.spacing_m = v; });
  keys.on("dives", [&](const YAML::Node& value) {
    for (const YAML::Node& one : value) project.dives.push_back(readDive(file, one));
  });
  keys.read(node);
  if (project.map.empty() && project.dives.empty())
    keys.fail(node.Mark(), "'map' (file of a map) or 'dives' (with 'run' in each) is wanted");
  for (const ProjectDive& dive : project.dives) {
    if (project.map.empty() && dive.run.empty())
      keys.fail(node.Mark(), fmt::format("without 'map', dive '{}' wants its 'run'", dive.dive));
  }
  return project;
}

}  // namespace lodeline
