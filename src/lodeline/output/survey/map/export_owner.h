#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lodeline/output/survey/map/dive_map.h"

namespace lodeline {

/// The file with the notes of a map, which also says whose files of that name the folder holds:
/// "NAME_notes.txt".
std::string notesFileName(const std::string& name);
/// Its content: the run's folder and first stamp, then every note of the map, a line each.
std::string notesText(const DiveMap& map);

/// Throws UsageError where the folder holds one of these files, or notes of that name, and they are not of
/// this dive: its notes name another run folder and another first stamp, or nothing says whose they are.
void expectOwnFiles(const std::filesystem::path& folder, const DiveMap& map,
                    const std::vector<std::string>& file_names);

}  // namespace lodeline
