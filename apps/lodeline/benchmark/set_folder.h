#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lodeline {

/// The folder in which somebody keeps a public set. Archives are unpacked in many ways, so a file is looked
/// for below each folder of the set, from the top down.
class SetFolder {
 public:
  /// Lists the folders down to four levels below `folder`. Throws InputError where there is no such folder.
  explicit SetFolder(const std::filesystem::path& folder);

  const std::filesystem::path& path() const { return folders_.front(); }

  /// The first file or folder that fits a pattern with `*` and {word}; empty where none does.
  std::optional<std::filesystem::path> find(const std::string& pattern,
                                            const std::map<std::string, std::string>& words) const;

 private:
  std::vector<std::filesystem::path> folders_;  ///< upper ones first, each level by name
};

/// A pattern with each {word} replaced.
std::string withWords(std::string pattern, const std::map<std::string, std::string>& words);

}  // namespace lodeline
