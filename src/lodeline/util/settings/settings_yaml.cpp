#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <ostream>
#include <set>

#include "lodeline/diagnostics.h"
#include "lodeline/util/settings/settings.h"

namespace lodeline {
namespace {

std::vector<std::string> splitPath(const std::string& key) {
  std::vector<std::string> parts;
  size_t begin = 0;
  for (size_t dot = key.find('.'); dot != std::string::npos; dot = key.find('.', begin)) {
    parts.push_back(key.substr(begin, dot - begin));
    begin = dot + 1;
  }
  parts.push_back(key.substr(begin));
  return parts;
}

void writeComment(const std::string& text, const std::string& indent, std::ostream& stream) {
  size_t begin = 0;
  while (begin < text.size()) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    stream << indent << "# " << text.substr(begin, end - begin) << '\n';
    begin = end + 1;
  }
}

/// Order of the keys in which the members of each section are adjacent, at the place of the first member.
std::vector<size_t> sectionOrder(const std::vector<std::string>& keys) {
  std::map<std::string, size_t> first_use;
  std::vector<std::pair<std::vector<size_t>, size_t>> ranked;
  for (size_t i = 0; i < keys.size(); ++i) {
    std::vector<size_t> ranks;
    for (size_t dot = keys[i].find('.'); dot != std::string::npos; dot = keys[i].find('.', dot + 1)) {
      ranks.push_back(first_use.emplace(keys[i].substr(0, dot), i).first->second);
    }
    ranks.push_back(i);
    ranked.emplace_back(std::move(ranks), i);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<size_t> order;
  for (const auto& [ranks, index] : ranked) order.push_back(index);
  return order;
}

}  // namespace

/// Reads a configuration file and applies each value.
class Settings::FileReader {
 public:
  FileReader(Settings* settings, std::string source) : settings_(settings), source_(std::move(source)) {}

  void readMap(const YAML::Node& map, const std::string& prefix) {
    for (const auto& item : map) {
      const std::string key = prefix + item.first.Scalar();
      const std::string place = fmt::format("{}:{}", source_, item.first.Mark().line + 1);
      const bool is_section = settings_->isSection(key);
      if (!seen_.insert(key).second) {
        throw UsageError(fmt::format("{}: '{}' occurs more than once; keep one", place, key));
      }
      if (is_section && item.second.IsMap()) {
        readMap(item.second, key + ".");
      } else if (is_section && !item.second.IsNull()) {
        throw UsageError(fmt::format("{}: '{}' is a section; write its settings indented below", place, key));
      } else if (!is_section) {
        settings_->apply({key, place, textOf(item.second)});
      }
    }
  }

  /// Converts a node to text. Maps and nested lists, which no setting accepts, become lists with an empty
  /// scalar.
  static Text textOf(const YAML::Node& node) {
    Text text;
    text.is_list = !node.IsScalar() && !node.IsNull();
    if (node.IsNull()) text.scalars.emplace_back();
    if (node.IsScalar()) text.scalars.push_back(node.Scalar());
    if (node.IsSequence()) {
      for (const YAML::Node& item : node) text.scalars.push_back(item.IsScalar() ? item.Scalar() : "");
    }
    if (node.IsMap()) text.scalars.emplace_back();
    return text;
  }

 private:
  Settings* settings_;
  std::string source_;
  std::set<std::string> seen_;
};

void Settings::load(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file)) {
    throw UsageError(fmt::format("{}: the configuration cannot be opened", file.string()));
  }
  YAML::Node root;
  try {
    root = YAML::Load(stream);
  } catch (const YAML::Exception& error) {
    throw UsageError(fmt::format("{}:{}: not valid YAML: {}", file.string(), error.mark.line + 1, error.msg));
  }
  if (root.IsNull()) return;
  if (!root.IsMap()) {
    throw UsageError(fmt::format("{}: a configuration is made of 'key: value' lines", file.string()));
  }
  FileReader(this, file.string()).readMap(root, "");
}

void Settings::set(const std::string& key, const std::string& value) {
  Assignment assignment{key, "command line", {}};
  try {
    assignment.value = FileReader::textOf(YAML::Load(value));
  } catch (const YAML::Exception&) {
    assignment.value.scalars = {value};
  }
  apply(assignment);
}

void Settings::write(std::ostream& stream) const {
  std::vector<std::string> keys;
  for (const Entry& entry : entries_) keys.push_back(entry.key);
  std::vector<std::string> open;
  for (const size_t index : sectionOrder(keys)) {
    const Entry& entry = entries_[index];
    const std::vector<std::string> parts = splitPath(entry.key);
    size_t depth = 0;
    while (depth < open.size() && depth + 1 < parts.size() && open[depth] == parts[depth]) ++depth;
    open.resize(depth);
    for (; depth + 1 < parts.size(); ++depth) {
      stream << std::string(2 * depth, ' ') << parts[depth] << ":\n";
      open.push_back(parts[depth]);
    }
    const std::string indent(2 * depth, ' ');
    writeComment(entry.documentation, indent, stream);
    stream << indent << parts.back() << ": " << entry.format() << '\n';
  }
}

}  // namespace lodeline
