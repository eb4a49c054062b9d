#pragma once

#include "lodeline/output/walls/dive_depths.h"
#include "lodeline/output/walls/section/wall_sections.h"

namespace lodeline {

struct WallOptions {
  DiveDepthOptions depths;
  FusionOptions fusion;
  SectionOptions sections;
};

/// What `walls` made.
struct WallResult {
  bool complete = true;  ///< false where `progress` ended the work; the next call goes on
  size_t keyframes = 0;
  double dive_s = 0.0;                                   ///< between the first keyframe and the last
  double depths_s = 0.0, fusion_s = 0.0, files_s = 0.0;  ///< on the clock
  WallTiles tiles;
  std::vector<StationWalls> stations;
  PassageVolume volume;
  std::vector<std::filesystem::path> files;
};

/// Dense walls of a dive. Computes the depths of keyframes, fuses them tile by tile, and writes cloud.ply,
/// cloud.las, mesh.ply, mesh.glb, sections.csv, sections.svg and (with GDAL) sections.dxf into `folder`.
///
/// Depths and finished tiles are in folder/work until the end. A call with the same input goes on where an
/// earlier one ended; other input starts anew. Memory does not grow with the dive. `cameras`: one or two, as
/// camerasOfRun(). Throws EstimationError where no surface was seen often enough, UsageError without Open3D
/// and InputError where a file cannot be written.
WallResult makeWalls(const DiveMap& map, MeasurementSource& source,
                     const std::vector<CameraCalibration>& cameras, const WallOptions& options,
                     const std::filesystem::path& folder, const WallProgress& progress,
                     Diagnostics* diagnostics);

}  // namespace lodeline
