#pragma once

#include <filesystem>
#include <string>

#include "lodeline/output/walls/walls.h"

namespace lodeline {

/// Text that is equal for equal input of makeWalls(): options, cameras and poses.
std::string wallInput(const DiveMap& map, const std::vector<CameraCalibration>& cameras,
                      const WallOptions& options);

/// Prepares the folder of unfinished work: keeps that of the same input, and deletes any other.
void claimWork(const std::filesystem::path& work, const std::string& input);

/// Fuses all tiles with points, in order, dividing those that are too large. Finished tiles are read from
/// their files. Nothing where `progress` ended the work.
std::optional<WallTiles> fuseTiles(const DiveDepths& depths, int tile_blocks, const FusionOptions& options,
                                   const std::filesystem::path& work, const WallProgress& progress);

}  // namespace lodeline
