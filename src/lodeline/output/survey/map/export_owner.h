#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lodeline/output/survey/map/dive_map.h"

namespace lodeline {

/// Name of the file with the notes of a map, which also identifies the run of the exported files:
/// "NAME_notes.txt".
std::string notesFileName(const std::string& name);
/// Its content: the run's folder and first stamp, then every note of the map, one per line.
std::string notesText(const DiveMap& map);

/// Throws UsageError where the folder contains one of these files, or notes of that name, from another dive:
/// its notes name another run folder and another first stamp, or there are no notes.
void expectOwnFiles(const std::filesystem::path& folder, const DiveMap& map,
                    const std::vector<std::string>& file_names);

}  // namespace lodeline
