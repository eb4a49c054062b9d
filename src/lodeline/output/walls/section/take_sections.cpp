#include <cmath>
#include <numbers>

#include "lodeline/output/walls/section/wall_sections.h"

namespace lodeline {
namespace {

/// The wall of a section in the middle of each of `count` sectors, by the nearest known direction of the
/// sector; empty where the section does not know the wall.
std::vector<std::optional<Vec3>> wallsInSectors(const StationWalls& walls, size_t count) {
  const auto& radii_m = walls.outline.radii_m;
  std::vector<std::optional<Vec3>> points(count);
  std::vector<double> off_middle(count, HUGE_VAL);
  for (size_t i = 0; i < radii_m.size(); ++i) {
    if (!radii_m[i]) continue;
    const double angle_rad = walls.outline.angle_rad(i);
    const Vec2 point = *radii_m[i] * Vec2(std::cos(angle_rad), std::sin(angle_rad));
    const size_t sector = sectorOf(point, count);
    const double width_rad = 2.0 * std::numbers::pi / static_cast<double>(count);
    const double off_rad = std::abs(
        std::remainder(angle_rad - (static_cast<double>(sector) + 0.5) * width_rad, 2.0 * std::numbers::pi));
    if (off_rad >= off_middle[sector]) continue;
    off_middle[sector] = off_rad;
    points[sector] = walls.across.inSpace(point);
  }
  return points;
}

void takeSplays(const StationWalls& walls, size_t sectors, SurveyStation* station) {
  const std::vector<std::optional<Vec3>> points = wallsInSectors(walls, sectors);
  std::erase_if(station->splays_ENU, [&](const Vec3& splay) {
    return points[sectorOf(walls.across.inPlane(splay), sectors)].has_value();
  });
  for (const std::optional<Vec3>& point : points) {
    if (point) station->splays_ENU.push_back(*point);
  }
}

bool seesWalls(const StationWalls& walls) { return walls.outline.coverage > 0.0; }

}  // namespace

void takeSections(const std::vector<StationWalls>& walls, size_t splay_sectors, Survey* survey) {
  for (size_t i = 0; i < walls.size(); ++i) {
    SurveyStation& station = survey->stations[i];
    for (std::optional<double> PassageSize::*distance :
         {&PassageSize::left, &PassageSize::right, &PassageSize::up, &PassageSize::down}) {
      if (walls[i].size.*distance) station.passage.*distance = walls[i].size.*distance;
    }
    if (splay_sectors > 0) takeSplays(walls[i], splay_sectors, &station);
  }
}

void takeEchoSections(const EchoSectionOptions& options, size_t splay_sectors, CaveSurvey* cave) {
  std::vector<Vec3> echoes;
  for (const DiveMap& dive : cave->dives)
    echoes.insert(echoes.end(), dive.echoes_ENU.begin(), dive.echoes_ENU.end());
  if (echoes.empty()) return;
  std::vector<bool> is_taken(cave->stations.size(), false);
  for (const CaveLegs& legs : cave->legs) {
    if (legs.is_connection || legs.stations.size() < 2) continue;
    Survey line;
    for (const size_t station : legs.stations) line.stations.push_back(cave->stations[station].station);
    const std::vector<StationWalls> walls = echoesAtStations(echoes, line, options);
    takeSections(walls, splay_sectors, &line);
    for (size_t i = 0; i < legs.stations.size(); ++i) {
      const size_t station = legs.stations[i];
      if (is_taken[station] || !seesWalls(walls[i])) continue;
      is_taken[station] = true;
      cave->stations[station].station = line.stations[i];
    }
  }
}

}  // namespace lodeline
