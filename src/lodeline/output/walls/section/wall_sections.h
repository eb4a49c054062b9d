#pragma once

#include <string>
#include <vector>

#include "lodeline/output/survey/cave/cave_survey.h"
#include "lodeline/output/survey/map/dive_map.h"
#include "lodeline/output/walls/files/wall_tiles.h"
#include "lodeline/output/walls/section/cross_section.h"

namespace lodeline {

/// The walls at one station of the survey.
struct StationWalls {
  SectionPlane across;             ///< plane across the passage
  std::vector<SectionLine> lines;  ///< of the walls in it
  SectionOutline outline;
  PassageSize size;  ///< by the walls, in the vertical plane
  /// Of the passage from this station to the next, m3: mean area times the leg. Empty where an area is
  /// unknown, and where the leg runs along a passage that earlier legs have measured.
  std::optional<double> volume_to_next_m3;
};

/// Cuts the walls at every station. Reads one tile at a time.
std::vector<StationWalls> wallsAtStations(const WallTiles& tiles, const Survey& survey,
                                          const SectionOptions& options);

/// Sections from wall points that a scanning sonar measured. In each sector of the plane the median distance
/// of the points nearest to the plane counts, up to `half_slab_m` before and behind it. The lines join the
/// walls of neighbouring sectors.
struct EchoSectionOptions {
  SectionOptions section;
  double half_slab_m = 2.5;
  size_t points_in_sector = 5;  ///< at most
};
std::vector<StationWalls> echoesAtStations(const std::vector<Vec3>& echoes, const Survey& survey,
                                           const EchoSectionOptions& options);

/// Replaces the distances left, right, up and down of the stations by those of the sections, where known. In
/// each of `splay_sectors` sectors of the plane where a section knows the wall, it also replaces the splays:
/// one to the wall in the middle of the sector.
void takeSections(const std::vector<StationWalls>& walls, size_t splay_sectors, Survey* survey);

/// Takes the sections of all echoes of the dives of a cave, in the same way. A station of several passages
/// has those of the first passage in which the sonar saw walls there.
void takeEchoSections(const EchoSectionOptions& options, size_t splay_sectors, CaveSurvey* cave);

/// Sum of the known volumes and the length of their legs.
struct PassageVolume {
  double volume_m3 = 0.0, length_m = 0.0;
};
PassageVolume passageVolume(const std::vector<StationWalls>& walls, const Survey& survey);

/// One line per station: position, distances, area, coverage and volume.
std::string sectionsCsv(const DiveMap& map, const std::vector<StationWalls>& walls);
/// All sections on one sheet, in one scale, as seen along the passage.
std::string sectionsSvg(const DiveMap& map, const std::vector<StationWalls>& walls);
/// All sections in space, layers SECTIONS and NAMES. Throws UsageError without GDAL.
std::string sectionsDxf(const DiveMap& map, const std::vector<StationWalls>& walls);

}  // namespace lodeline
