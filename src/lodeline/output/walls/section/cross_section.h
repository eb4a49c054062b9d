#pragma once

#include <optional>
#include <vector>

#include "lodeline/output/survey/map/passage.h"
#include "lodeline/output/walls/fusion/wall_mesh.h"

namespace lodeline {

/// Axes in the plane of a section, and in space.
struct SectionPlane {
  Vec3 origin = Vec3::Zero();  ///< the station, map
  Vec3 right = Vec3::UnitX();  ///< unit, as seen along the passage
  Vec3 above = Vec3::UnitZ();  ///< unit

  Vec3 normal() const { return above.cross(right); }
  Vec2 inPlane(const Vec3& point) const { return {(point - origin).dot(right), (point - origin).dot(above)}; }
  Vec3 inSpace(const Vec2& point) const { return origin + point.x() * right + point.y() * above; }
};

/// The plane across the passage at a station.
SectionPlane planeAcross(const PassageSection& section);
/// The vertical plane across the passage; distances left, right, up and down are measured in it.
SectionPlane verticalPlane(const PassageSection& section);

/// Line of the walls in a plane, m from the station to the right and above.
struct SectionLine {
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();
};

/// Appends the lines in which a mesh cuts a plane, up to `reach_m` from the station.
void cutMesh(const WallMesh& mesh, const SectionPlane& plane, double reach_m,
             std::vector<SectionLine>* lines);

struct SectionOptions {
  double reach_m = 15.0;
  size_t sectors = 72;          ///< about the station, of 5 degrees
  size_t max_gap_sectors = 6;   ///< wider gaps of the walls stay open
  double least_coverage = 0.7;  ///< share of the sectors with walls for an area
};

/// The walls about a station, by directions in the plane.
struct SectionOutline {
  std::vector<std::optional<double>> radii_m;  ///< by sector, counter-clockwise from the right; its middle
  double coverage = 0.0;                       ///< share of the sectors with walls
  double seen_area_m2 = 0.0;                   ///< of the sectors with walls: the least the section has
  std::optional<double> area_m2;               ///< empty where the outline is open

  double angle_rad(size_t sector) const;
  /// Median distance of the sectors within 7.5 degrees of a direction.
  std::optional<double> towards(double angle_rad) const;
};

/// Outline with known radii. Gaps of up to `max_gap_sectors` are filled from both sides for the area, wider
/// gaps leave it empty.
SectionOutline outlineOf(std::vector<std::optional<double>> radii_m, const SectionOptions& options);
/// In each sector the nearest walls count.
SectionOutline outlineOf(const std::vector<SectionLine>& lines, const SectionOptions& options);

/// Sector of a point in the plane.
size_t sectorOf(const Vec2& point, size_t sectors);

}  // namespace lodeline
