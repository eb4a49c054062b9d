#include "apps/lodeline/batch/batch_list.h"

#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <sstream>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/pipeline/run_recording.h"
#include "lodeline/util/choice.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;

struct ListedRecording {
  std::string name, data, truth;
  Words simulate, arguments;
};

struct ListedVariant {
  std::string name;
  Words arguments;
};

bool isNameLetter(char letter) {
  return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_' || letter == '-';
}

/// Reads the parts of a list with error messages that name file and line.
class BatchListReader {
 public:
  explicit BatchListReader(fs::path file) : file_(std::move(file)) {}

  [[noreturn]] void refuse(const YAML::Node& node, const std::string& reason) const {
    throw UsageError(fmt::format("{}:{}: {}", file_.string(), node.Mark().line + 1, reason));
  }

  void requireKeys(const YAML::Node& node, const Words& known, const std::string& what) const {
    if (!node.IsMap()) refuse(node, what + " needs keys and values");
    for (const auto& entry : node) {
      const std::string key = entry.first.Scalar();
      if (std::find(known.begin(), known.end(), key) != known.end()) continue;
      refuse(entry.first, fmt::format("unknown key '{}' in {}{}", key, what, didYouMean(key, known)));
    }
  }

  std::string word(const YAML::Node& node, const std::string& what) const {
    if (!node.IsScalar() || node.Scalar().empty()) refuse(node, what + " is not a word");
    return node.Scalar();
  }

  /// Words of a list, or of a text that is split at blanks; none where the key is missing.
  Words words(const YAML::Node& node, const std::string& what) const {
    Words found;
    if (!node.IsDefined() || node.IsNull()) return found;
    if (node.IsScalar()) {
      std::istringstream text(node.Scalar());
      for (std::string part; text >> part;) found.push_back(part);
    } else if (node.IsSequence()) {
      for (const YAML::Node& entry : node) found.push_back(word(entry, what));
    } else {
      refuse(node, what + " needs a list of words");
    }
    return found;
  }

  std::string name(const YAML::Node& node) const {
    const std::string text = word(node, "name");
    if (!std::all_of(text.begin(), text.end(), isNameLetter)) {
      refuse(node, fmt::format("name '{}': letters, digits, - and _ are allowed", text));
    }
    return text;
  }

  std::string existing(const YAML::Node& node, const std::string& what) const {
    const std::string path = word(node, what);
    std::error_code ignored;
    if (!fs::exists(file_.parent_path() / path, ignored)) {
      refuse(node,
             fmt::format("{} {} does not exist; relative paths start at the list's folder", what, path));
    }
    return path;
  }

  void requireNewName(const YAML::Node& node, const std::string& name, std::set<std::string>* names) const {
    if (!names->insert(name).second) {
      refuse(node, fmt::format("name '{}' is used twice; give another `name`", name));
    }
  }

  ListedRecording recording(const YAML::Node& node) const {
    ListedRecording listed;
    if (node.IsScalar()) {
      listed.data = existing(node, "recording");
    } else {
      requireKeys(node, {"data", "simulate", "name", "args", "truth"}, "a recording");
      if (node["data"].IsDefined() == node["simulate"].IsDefined()) {
        refuse(node, "a recording needs one of `data` and `simulate`");
      }
      if (node["data"].IsDefined()) listed.data = existing(node["data"], "recording");
      listed.simulate = words(node["simulate"], "simulate");
      if (node["simulate"].IsDefined() && listed.simulate.empty())
        refuse(node, "`simulate` names no scenario");
      listed.arguments = words(node["args"], "args");
      if (node["truth"].IsDefined()) listed.truth = existing(node["truth"], "truth");
      if (node["name"].IsDefined()) listed.name = name(node["name"]);
    }
    if (listed.name.empty()) listed.name = defaultName(listed);
    return listed;
  }

  ListedVariant variant(const YAML::Node& node) const {
    requireKeys(node, {"name", "set", "args"}, "a variant");
    if (!node["name"].IsDefined()) refuse(node, "a variant needs a `name`");
    ListedVariant listed{name(node["name"]), words(node["args"], "args")};
    const YAML::Node settings = node["set"];
    if (!settings.IsDefined() || settings.IsNull()) return listed;
    if (settings.IsScalar()) addSetting(settings, settings.Scalar(), &listed);
    if (settings.IsSequence()) {
      for (const YAML::Node& setting : settings) addSetting(setting, word(setting, "set"), &listed);
    }
    if (settings.IsMap()) {
      for (const auto& setting : settings) {
        addSetting(setting.first, setting.first.Scalar() + "=" + flowText(setting.second), &listed);
      }
    }
    return listed;
  }

  std::vector<int> seeds(const YAML::Node& node) const {
    std::vector<int> found;
    if (!node.IsDefined() || node.IsNull()) return found;
    if (!node.IsSequence()) refuse(node, "seeds needs a list of whole numbers");
    for (const YAML::Node& entry : node) {
      int seed = -1;
      if (!YAML::convert<int>::decode(entry, seed) || seed < 0) {
        refuse(entry, "a seed is a whole number from 0 on");
      }
      if (std::find(found.begin(), found.end(), seed) != found.end())
        refuse(entry, "this seed is there twice");
      found.push_back(seed);
    }
    return found;
  }

  std::optional<double> tolerance_s(const YAML::Node& node) const {
    if (!node.IsDefined()) return std::nullopt;
    double seconds = 0.0;
    if (!YAML::convert<double>::decode(node, seconds) || !(seconds > 0.0 && seconds <= 1.0)) {
      refuse(node, "tolerance_s is a number of seconds above 0, at most 1");
    }
    return seconds;
  }

 private:
  static std::string defaultName(const ListedRecording& listed) {
    fs::path path =
        listed.simulate.empty() ? fs::path(listed.data).lexically_normal() : fs::path(listed.simulate[0]);
    if (!path.has_filename()) path = path.parent_path();
    std::string name = path.filename().string();
    if (name == "mav0" && path.has_parent_path()) name = path.parent_path().filename().string();
    std::replace_if(
        name.begin(), name.end(), [](char letter) { return !isNameLetter(letter); }, '_');
    return name;
  }

  /// The value of a setting on one line, as `--set` expects it.
  static std::string flowText(const YAML::Node& node) {
    if (node.IsScalar()) return node.Scalar();
    YAML::Emitter text;
    text.SetMapFormat(YAML::Flow);
    text.SetSeqFormat(YAML::Flow);
    text << node;
    return text.c_str();
  }

  void addSetting(const YAML::Node& node, const std::string& setting, ListedVariant* listed) const {
    RunRequest request;
    request.overrides = {setting};
    RunSettings options;
    Settings settings;
    try {
      applyRequest(request, &settings, &options);
    } catch (const UsageError& error) {
      refuse(node, error.what());
    }
    listed->arguments.insert(listed->arguments.end(), {"--set", setting});
  }

  fs::path file_;
};

YAML::Node loadList(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) throw UsageError(file.string() + ": there is no such list");
  try {
    return loadYamlFile(file);
  } catch (const InputError& error) {
    throw UsageError(error.what());
  }
}

BatchItem makeItem(const ListedRecording& recording, const ListedVariant& variant, std::optional<int> seed,
                   const Words& common) {
  BatchItem item;
  const std::string suffix = seed ? fmt::format(".{}", *seed) : "";
  item.name = recording.name + "." + variant.name + suffix;
  item.recording = recording.name;
  item.variant = variant.name;
  item.seed = seed;
  item.data = recording.data;
  item.truth = recording.truth;
  item.simulate = recording.simulate;
  for (const Words& words : {common, recording.arguments, variant.arguments}) {
    item.arguments.insert(item.arguments.end(), words.begin(), words.end());
  }
  if (!item.simulate.empty()) {
    item.simulated_name = recording.name + suffix;
    if (seed) item.simulate.insert(item.simulate.end(), {"--seed", std::to_string(*seed)});
  } else if (seed) {
    item.arguments.insert(item.arguments.end(), {"--set", fmt::format("front_end.seed={}", *seed)});
  }
  return item;
}

}  // namespace

BatchList readBatchList(const fs::path& file) {
  const YAML::Node root = loadList(file);
  const BatchListReader reader(fs::absolute(file).lexically_normal());
  reader.requireKeys(root, {"recordings", "variants", "seeds", "args", "align", "tolerance_s"}, "the list");
  if (!root["recordings"].IsDefined() || !root["recordings"].IsSequence() || root["recordings"].size() == 0) {
    reader.refuse(root, "the list needs `recordings` with at least one entry");
  }
  BatchList list;
  list.folder = fs::absolute(file).lexically_normal().parent_path();
  if (root["align"].IsDefined()) {
    try {
      list.alignment = alignmentTypeFromString(reader.word(root["align"], "align"));
    } catch (const UsageError& error) {
      reader.refuse(root["align"], error.what());
    }
  }
  list.tolerance_s = reader.tolerance_s(root["tolerance_s"]);
  std::set<std::string> names;
  std::vector<ListedVariant> variants;
  if (root["variants"].IsDefined() && !root["variants"].IsSequence()) {
    reader.refuse(root["variants"], "variants needs a list");
  }
  if (root["variants"].IsDefined()) {
    for (const YAML::Node& node : root["variants"]) {
      variants.push_back(reader.variant(node));
      reader.requireNewName(node, variants.back().name, &names);
    }
  }
  if (variants.empty()) variants.push_back({"default", {}});
  names.clear();
  const Words common = reader.words(root["args"], "args");
  std::vector<std::optional<int>> seeds;
  for (const int seed : reader.seeds(root["seeds"])) seeds.emplace_back(seed);
  if (seeds.empty()) seeds.emplace_back();
  for (const YAML::Node& node : root["recordings"]) {
    const ListedRecording recording = reader.recording(node);
    reader.requireNewName(node, recording.name, &names);
    for (const ListedVariant& variant : variants) {
      for (const std::optional<int>& seed : seeds) {
        list.items.push_back(makeItem(recording, variant, seed, common));
      }
    }
  }
  return list;
}

BatchShard batchShardFromText(const std::string& text) {
  size_t index = 0;
  size_t count = 0;
  char slash = 0;
  std::istringstream stream(text);
  const bool is_digits = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char letter) {
    return std::isdigit(letter) != 0 || letter == '/';
  });
  if (!is_digits || !(stream >> index >> slash >> count) || slash != '/' || !stream.eof() || index < 1 ||
      index > count) {
    throw UsageError(fmt::format("--shard {}: expected I/N with I from 1 to N, for example 3/10", text));
  }
  return {index - 1, count};
}

}  // namespace lodeline
