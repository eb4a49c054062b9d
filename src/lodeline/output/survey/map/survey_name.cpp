#include "lodeline/output/survey/map/survey_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

namespace lodeline {
namespace {

/// The last `count` parts of a path, joined by '_'.
std::string lastParts(const std::filesystem::path& path, size_t count) {
  std::filesystem::path rest = path;
  std::string name;
  for (size_t i = 0; i < count && rest.has_filename(); ++i, rest = rest.parent_path()) {
    name = fmt::format("{}{}{}", rest.filename().string(), name.empty() ? "" : "_", name);
  }
  return surveyName(name);
}

std::filesystem::path fullPath(const std::filesystem::path& folder) {
  const std::filesystem::path absolute = std::filesystem::absolute(folder).lexically_normal();
  return absolute.has_filename() ? absolute : absolute.parent_path();
}

std::string foldedCase(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name;
}

bool areDifferent(const std::vector<std::string>& names) {
  std::set<std::string> seen;
  return std::all_of(names.begin(), names.end(),
                     [&](const std::string& name) { return seen.insert(foldedCase(name)).second; });
}

}  // namespace

std::string surveyName(const std::string& name) {
  constexpr size_t kMostCharacters = 64;
  std::string allowed = name.substr(0, kMostCharacters);
  for (char& c : allowed) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-') c = '_';
  }
  if (allowed.starts_with('-')) allowed.front() = '_';
  return allowed.empty() ? "dive" : allowed;
}

std::vector<std::string> surveyNames(const std::vector<std::filesystem::path>& folders) {
  constexpr size_t kMostParts = 4;
  std::vector<std::string> names;
  for (size_t parts = 1; parts <= kMostParts; ++parts) {
    names.clear();
    for (const std::filesystem::path& folder : folders) names.push_back(lastParts(fullPath(folder), parts));
    if (areDifferent(names)) return names;
  }
  for (size_t i = 0; i < names.size(); ++i)
    names[i] = fmt::format("{}_{}", lastParts(fullPath(folders[i]), 1), i + 1);
  return names;
}

}  // namespace lodeline
