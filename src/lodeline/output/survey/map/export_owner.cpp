#include "lodeline/output/survey/map/export_owner.h"

#include <fmt/format.h>

#include <fstream>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

std::string folderLine(const DiveMap& map) { return "run folder: " + map.run_folder.string(); }

std::string stampLine(const DiveMap& map) {
  return fmt::format("first pose: {} ns", map.trajectory.poses.front().time.nanoseconds());
}

}  // namespace

std::string notesFileName(const std::string& name) { return name + "_notes.txt"; }

std::string notesText(const DiveMap& map) {
  std::string text = folderLine(map) + "\n" + stampLine(map) + "\n";
  for (const std::string& note : map.notes) text += note + "\n";
  return text;
}

void expectOwnFiles(const std::filesystem::path& folder, const DiveMap& map,
                    const std::vector<std::string>& file_names) {
  const std::filesystem::path notes = folder / notesFileName(map.name);
  std::string owner, stamp;
  if (std::ifstream stream(notes); stream) {
    std::getline(stream, owner);
    std::getline(stream, stamp);
    if (owner == folderLine(map) || stamp == stampLine(map)) return;
  }
  std::vector<std::string> names = file_names;
  names.push_back(notes.filename().string());
  for (const std::string& name : names) {
    if (!std::filesystem::exists(folder / name)) continue;
    throw UsageError(
        fmt::format("{} is there already, and not of this dive{}; choose another name with --name or another "
                    "folder with -o, "
                    "or replace it with --overwrite",
                    (folder / name).string(), owner.empty() ? "" : fmt::format(" (its {})", owner)));
  }
}

}  // namespace lodeline
