#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "apps/lodeline/batch/batch_list.h"

namespace lodeline {

/// Where an item of a batch stands.
enum class ItemState { Open, Done, Failed };

/// The output folder of a batch: results/NAME, failed/NAME, recordings/NAME, and locks and work in progress
/// in hidden folders. Each result and failure has a file item.json.
class BatchFolder {
 public:
  explicit BatchFolder(const std::filesystem::path& folder);

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path result(const BatchItem& item) const { return folder_ / "results" / item.name; }
  std::filesystem::path failure(const BatchItem& item) const { return folder_ / "failed" / item.name; }
  std::filesystem::path simulated(const BatchItem& item) const {
    return folder_ / "recordings" / item.simulated_name;
  }
  std::filesystem::path lock(const std::string& name) const { return folder_ / ".locks" / name; }
  /// Folder of unfinished files of one item. Only the process that has claimed it may use it.
  std::filesystem::path work(const std::string& name) const { return folder_ / ".work" / name; }

  /// State by item.json. A result or failure made from something else (`key`) counts as open.
  ItemState state(const BatchItem& item, const std::string& key) const;
  /// Whether the simulated recording of the item exists.
  bool isSimulated(const BatchItem& item) const;

 private:
  std::filesystem::path folder_;
};

/// Text of everything that the result of an item depends on: the program, the words of its command, sizes of
/// the recording's files, and contents of small files that the words name.
std::string keyOfItem(const BatchItem& item, const BatchList& list);
/// The same for the simulated recording of an item.
std::string keyOfSimulation(const BatchItem& item);

/// item.json of a folder; null where it is missing or damaged.
nlohmann::ordered_json readItemFile(const std::filesystem::path& folder);
void writeItemFile(const std::filesystem::path& folder, const nlohmann::ordered_json& json);

/// Replaces a file at once, so that other processes never read half of it.
void replaceFile(const std::filesystem::path& file, const std::string& text);

/// Moves a finished folder to its place, and replaces what is there.
void publishFolder(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace lodeline
