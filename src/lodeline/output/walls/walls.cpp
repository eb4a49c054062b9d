#include "lodeline/output/walls/walls.h"

#include <fmt/format.h>

#include <chrono>

#include "lodeline/output/survey/formats/write_formats.h"
#include "lodeline/output/walls/files/write_las.h"
#include "lodeline/output/walls/fusion/wall_volume.h"
#include "lodeline/output/walls/wall_work.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

constexpr int kTileBlocks = 48;

/// Time since the last call.
class Stopwatch {
 public:
  double lap_s() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void reportOpenSections(const std::vector<StationWalls>& stations, Diagnostics* diagnostics) {
  size_t open = 0;
  for (const StationWalls& station : stations) open += station.outline.area_m2 ? 0 : 1;
  if (open == 0) return;
  diagnostics->report(
      2 * open > stations.size() ? Severity::Warning : Severity::Notice, "walls_section_open",
      fmt::format("{} of {} stations have walls on too few sides for an area; walls behind and "
                  "beside the camera are seen only where it turned there",
                  open, stations.size()));
}

void writeFiles(const DiveMap& map, const std::filesystem::path& folder, WallResult* result) {
  const auto write = [&](const char* name, const auto& writer) {
    result->files.push_back(folder / name);
    writer(result->files.back());
  };
  const WallTiles& tiles = result->tiles;
  std::vector<std::string> notes = map.notes;
  notes.push_back(
      fmt::format("metres {} from the first pose; walls of {} keyframes", map.north.axes, result->keyframes));
  write("cloud.ply", [&](const auto& file) { writeWallsPly(tiles, notes, false, file); });
  write("mesh.ply", [&](const auto& file) { writeWallsPly(tiles, notes, true, file); });
  write("mesh.glb", [&](const auto& file) { writeWallsGlb(tiles, notes, file); });
  write("cloud.las", [&](const auto& file) { writeLas(tiles, map, file); });
  write("sections.csv", [&](const auto& file) { writeOutput(file, sectionsCsv(map, result->stations)); });
  write("sections.svg", [&](const auto& file) { writeOutput(file, sectionsSvg(map, result->stations)); });
  if (hasGdal())
    write("sections.dxf", [&](const auto& file) { writeOutput(file, sectionsDxf(map, result->stations)); });
}

}  // namespace

WallResult makeWalls(const DiveMap& map, MeasurementSource& source,
                     const std::vector<CameraCalibration>& cameras, const WallOptions& options,
                     const std::filesystem::path& folder, const WallProgress& progress,
                     Diagnostics* diagnostics) {
  wallVolumeModule();  // throws at once where depths cannot be fused
  const std::filesystem::path work = folder / "work";
  claimWork(work, wallInput(map, cameras, options));
  const DepthStore store(work);
  WallResult result;
  Stopwatch watch;
  const DiveDepths depths =
      computeDepths(source, cameras, map.trajectory, options.depths, kTileBlocks * options.fusion.block_m(),
                    store, progress, diagnostics);
  result.depths_s = watch.lap_s();
  result.keyframes = depths.frames.keyframes.size();
  result.dive_s = depths.seconds;
  result.complete = depths.complete;
  if (!result.complete) return result;
  if (result.keyframes == 0)
    throw InputError("walls: no image of the recording has a pose: is it the run's recording?");
  const auto tiles = fuseTiles(depths, kTileBlocks, options.fusion, work, progress);
  result.fusion_s = watch.lap_s();
  result.complete = tiles.has_value();
  if (!result.complete) return result;
  if (tiles->files.empty()) {
    throw EstimationError(fmt::format("walls: none of {} keyframes shows a surface that {} of them see",
                                      result.keyframes, options.fusion.min_views));
  }
  result.tiles = *tiles;
  result.stations = wallsAtStations(result.tiles, map.survey, options.sections);
  result.volume = passageVolume(result.stations, map.survey);
  reportOpenSections(result.stations, diagnostics);
  writeFiles(map, folder, &result);
  result.files_s = watch.lap_s();
  progress("files", 1.0);
  return result;
}

}  // namespace lodeline
