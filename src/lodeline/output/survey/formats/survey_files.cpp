#include "lodeline/output/survey/formats/map_files.h"
#include "lodeline/output/survey/map/export_owner.h"
#include "lodeline/survey.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {

std::vector<std::filesystem::path> writeSurvey(const RunFolder& run, const DiveMapOptions& options,
                                               const std::vector<MapFormat>& formats,
                                               const std::filesystem::path& folder,
                                               Diagnostics* diagnostics) {
  const DiveMap map = makeDiveMap(run, options, {}, diagnostics);
  createOutputFolder(folder);
  std::vector<std::filesystem::path> files;
  for (MapFormat format : formats) {
    for (const std::filesystem::path& file : writeMap(map, std::nullopt, format, folder))
      files.push_back(file);
  }
  files.push_back(folder / notesFileName(map.name));
  writeOutput(files.back(), notesText(map));
  return files;
}

}  // namespace lodeline
