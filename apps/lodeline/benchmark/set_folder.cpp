#include "apps/lodeline/benchmark/set_folder.h"

#include <glob.h>

#include <algorithm>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

constexpr int kLevels = 4;

/// A path in which glob() takes every letter for itself.
std::string escaped(const std::string& path) {
  std::string text;
  for (const char letter : path) {
    if (std::string_view("*?[]\\").find(letter) != std::string_view::npos) text += '\\';
    text += letter;
  }
  return text;
}

std::optional<fs::path> firstMatch(const std::string& pattern) {
  glob_t found{};
  std::optional<fs::path> match;
  if (glob(pattern.c_str(), 0, nullptr, &found) == 0 && found.gl_pathc > 0) match = found.gl_pathv[0];
  globfree(&found);
  return match;
}

}  // namespace

SetFolder::SetFolder(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw InputError(folder.string() + ": there is no such folder");
  folders_.push_back(fs::absolute(folder).lexically_normal());
  size_t level_begin = 0;
  for (int level = 0; level < kLevels; ++level) {
    std::vector<fs::path> below;
    for (size_t i = level_begin; i < folders_.size(); ++i) {
      for (const auto& entry : fs::directory_iterator(folders_[i], error)) {
        if (entry.is_directory(error)) below.push_back(entry.path());
      }
    }
    std::sort(below.begin(), below.end());
    level_begin = folders_.size();
    folders_.insert(folders_.end(), below.begin(), below.end());
  }
}

std::optional<fs::path> SetFolder::find(const std::string& pattern,
                                        const std::map<std::string, std::string>& words) const {
  const std::string wanted = withWords(pattern, words);
  for (const fs::path& folder : folders_) {
    if (const auto match = firstMatch(escaped(folder.string()) + "/" + wanted)) return match;
  }
  return std::nullopt;
}

std::string withWords(std::string pattern, const std::map<std::string, std::string>& words) {
  for (const auto& [word, value] : words) {
    const std::string place = "{" + word + "}";
    for (size_t at = pattern.find(place); at != std::string::npos; at = pattern.find(place, at)) {
      pattern.replace(at, place.size(), value);
      at += value.size();
    }
  }
  return pattern;
}

}  // namespace lodeline
