#include "lodeline/output/walls/section/wall_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lodeline/output/survey/formats/gis/dxf_drawing.h"
#include "lodeline/output/survey/map/map_times.h"
#include "lodeline/trajectory.h"

namespace lodeline {
namespace {

bool mayCut(const Eigen::AlignedBox3d& box, const SectionPlane& plane, double reach_m) {
  return box.squaredExteriorDistance(plane.origin) <= reach_m * reach_m;
}

PassageSize sizeOf(const SectionOutline& outline) {
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  return {outline.towards(2.0 * kQuarter), outline.towards(0.0), outline.towards(kQuarter),
          outline.towards(-kQuarter)};
}

/// Whether the middle of a leg lies in a passage that an earlier leg has measured: nearer to its middle than
/// the half width there.
bool isMeasured(const std::vector<StationWalls>& walls, const Survey& survey, size_t leg) {
  const auto middleOf = [&](size_t i) -> Vec3 {
    return 0.5 * (survey.stations[i].position_ENU + survey.stations[i + 1].position_ENU);
  };
  for (size_t i = 0; i + 1 < leg; ++i) {
    if (!walls[i].volume_to_next_m3) continue;
    const double length_m = (survey.stations[i + 1].position_ENU - survey.stations[i].position_ENU).norm();
    const double near_m = std::max(0.5 * length_m, walls[i].size.left.value_or(0.0));
    if ((middleOf(i) - middleOf(leg)).norm() < near_m) return true;
  }
  return false;
}

void addVolumes(const Survey& survey, std::vector<StationWalls>* walls) {
  for (size_t i = 0; i + 1 < walls->size(); ++i) {
    const auto &here = (*walls)[i].outline.area_m2, &next = (*walls)[i + 1].outline.area_m2;
    if (!here || !next || isMeasured(*walls, survey, i)) continue;
    const Vec3 leg = survey.stations[i + 1].position_ENU - survey.stations[i].position_ENU;
    (*walls)[i].volume_to_next_m3 = 0.5 * (*here + *next) * leg.norm();
  }
}

/// Distances of the walls by sector: the median of the points nearest to the plane.
std::vector<std::optional<double>> echoRadii(const std::vector<Vec3>& echoes, const SectionPlane& plane,
                                             const EchoSectionOptions& options) {
  struct Echo {
    double off_plane_m, radius_m;
  };
  std::vector<std::vector<Echo>> sectors(options.section.sectors);
  for (const Vec3& echo : echoes) {
    const double off_plane_m = std::abs((echo - plane.origin).dot(plane.normal()));
    const Vec2 point = plane.inPlane(echo);
    if (off_plane_m > options.half_slab_m || point.norm() > options.section.reach_m) continue;
    sectors[sectorOf(point, sectors.size())].push_back({off_plane_m, point.norm()});
  }
  std::vector<std::optional<double>> radii_m(sectors.size());
  for (size_t i = 0; i < sectors.size(); ++i) {
    std::vector<Echo>& near = sectors[i];
    if (near.empty()) continue;
    std::stable_sort(near.begin(), near.end(),
                     [](const Echo& a, const Echo& b) { return a.off_plane_m < b.off_plane_m; });
    std::vector<double> distances;
    for (size_t k = 0; k < std::min(near.size(), options.points_in_sector); ++k)
      distances.push_back(near[k].radius_m);
    std::sort(distances.begin(), distances.end());
    radii_m[i] = quantile(distances, 0.5);
  }
  return radii_m;
}

/// Lines between the walls of neighbouring sectors, across gaps that the area fills.
std::vector<SectionLine> linesOf(const SectionOutline& outline, const SectionOptions& options) {
  const auto& radii_m = outline.radii_m;
  const auto pointOf = [&](size_t sector) -> Vec2 {
    const double angle_rad = outline.angle_rad(sector);
    return *radii_m[sector] * Vec2(std::cos(angle_rad), std::sin(angle_rad));
  };
  std::vector<SectionLine> lines;
  for (size_t i = 0; i < radii_m.size(); ++i) {
    if (!radii_m[i]) continue;
    for (size_t step = 1; step <= options.max_gap_sectors + 1; ++step) {
      const size_t next = (i + step) % radii_m.size();
      if (!radii_m[next]) continue;
      lines.push_back({pointOf(i), pointOf(next)});
      break;
    }
  }
  return lines;
}

}  // namespace

std::vector<StationWalls> wallsAtStations(const WallTiles& tiles, const Survey& survey,
                                          const SectionOptions& options) {
  const std::vector<PassageSection> sections = passageSections(survey.stations);
  std::vector<StationWalls> walls(sections.size());
  std::vector<std::vector<SectionLine>> vertical(sections.size());
  for (const std::filesystem::path& file : tiles.files) {
    const WallMesh mesh = readTileFile(file);
    Eigen::AlignedBox3d box;
    for (const WallMesh::Point& point : mesh.positions) box.extend(point.cast<double>());
    for (size_t i = 0; i < sections.size(); ++i) {
      const SectionPlane across = planeAcross(sections[i]);
      if (!mayCut(box, across, options.reach_m)) continue;
      cutMesh(mesh, across, options.reach_m, &walls[i].lines);
      cutMesh(mesh, verticalPlane(sections[i]), options.reach_m, &vertical[i]);
    }
  }
  for (size_t i = 0; i < sections.size(); ++i) {
    walls[i].across = planeAcross(sections[i]);
    walls[i].outline = outlineOf(walls[i].lines, options);
    walls[i].size = sizeOf(outlineOf(vertical[i], options));
  }
  addVolumes(survey, &walls);
  return walls;
}

std::vector<StationWalls> echoesAtStations(const std::vector<Vec3>& echoes, const Survey& survey,
                                           const EchoSectionOptions& options) {
  std::vector<StationWalls> walls;
  for (const PassageSection& section : passageSections(survey.stations)) {
    StationWalls& wall = walls.emplace_back();
    wall.across = planeAcross(section);
    wall.outline = outlineOf(echoRadii(echoes, wall.across, options), options.section);
    wall.lines = linesOf(wall.outline, options.section);
    wall.size = sizeOf(outlineOf(echoRadii(echoes, verticalPlane(section), options), options.section));
  }
  addVolumes(survey, &walls);
  return walls;
}

PassageVolume passageVolume(const std::vector<StationWalls>& walls, const Survey& survey) {
  PassageVolume sum;
  for (size_t i = 0; i + 1 < walls.size(); ++i) {
    if (!walls[i].volume_to_next_m3) continue;
    sum.volume_m3 += *walls[i].volume_to_next_m3;
    sum.length_m += (survey.stations[i + 1].position_ENU - survey.stations[i].position_ENU).norm();
  }
  return sum;
}

std::string sectionsCsv(const DiveMap& map, const std::vector<StationWalls>& walls) {
  const auto number = [](const std::optional<double>& value) {
    return value ? fmt::format("{:.3f}", *value) : std::string();
  };
  std::string text =
      "station,time,east_m,north_m,up_m,left_m,right_m,up_wall_m,down_wall_m,area_m2,coverage,"
      "volume_to_next_m3,seen_area_m2\n";
  for (size_t i = 0; i < walls.size(); ++i) {
    const SurveyStation& station = map.survey.stations[i];
    const StationWalls& wall = walls[i];
    text += fmt::format(
        "{},{},{:.3f},{:.3f},{:.3f},{},{},{},{},{},{:.3f},{},{:.3f}\n", i, isoTime(station.time).value_or(""),
        station.position_ENU.x(), station.position_ENU.y(), station.position_ENU.z(), number(wall.size.left),
        number(wall.size.right), number(wall.size.up), number(wall.size.down), number(wall.outline.area_m2),
        wall.outline.coverage, number(wall.volume_to_next_m3), wall.outline.seen_area_m2);
  }
  return text;
}

std::string sectionsDxf(const DiveMap& map, const std::vector<StationWalls>& walls) {
  DxfDrawing drawing;
  for (size_t i = 0; i < walls.size(); ++i) {
    const SectionPlane& plane = walls[i].across;
    for (const SectionLine& line : walls[i].lines) {
      drawing.lines.push_back(
          {"SECTIONS",
           {drawingPoint(map, plane.inSpace(line.from)), drawingPoint(map, plane.inSpace(line.to))}});
    }
    drawing.labels.push_back({"NAMES", drawingPoint(map, plane.origin), std::to_string(i), 0.3});
  }
  return dxfText(drawing, "sections");
}

}  // namespace lodeline
