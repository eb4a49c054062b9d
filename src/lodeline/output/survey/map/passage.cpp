#include "lodeline/output/survey/map/passage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lodeline/trajectory.h"

namespace lodeline {
namespace {

/// Horizontal direction to the left of `along`; `fallback` if that is nearly vertical.
Vec3 leftOf(const Vec3& along, const Vec3& fallback) {
  const Vec3 left = Vec3::UnitZ().cross(along);
  return left.norm() > 0.2 ? left.normalized() : fallback;
}

/// Mean direction of the legs that meet at a station; where the dive turns round, that of the leg before.
Vec3 directionAt(const std::vector<SurveyStation>& stations, size_t i) {
  const auto leg = [&](size_t from) {
    return (stations[from + 1].position_ENU - stations[from].position_ENU).normalized();
  };
  if (i == 0) return leg(0);
  if (i + 1 == stations.size()) return leg(i - 1);
  const Vec3 before = leg(i - 1), after = leg(i);
  return before.dot(after) < 0.0 ? before : (before + after).normalized();
}

/// Wall points near the plane across the passage, relative to the station.
std::vector<Vec3> pointsAcross(const std::vector<Vec3>& walls, const PassageSection& section,
                               const PassageOptions& options) {
  std::vector<Vec3> points;
  for (const Vec3& wall : walls) {
    const Vec3 point = wall - section.origin;
    if (std::abs(point.dot(section.along)) > options.half_slab_m) continue;
    if (point.squaredNorm() > options.reach_m * options.reach_m) continue;
    points.push_back(point);
  }
  return points;
}

/// Distances along a direction of the points in a cone about it.
std::vector<double> distancesIn(const std::vector<Vec3>& points, const Vec3& direction, double cone_rad) {
  const double least_cosine = std::cos(cone_rad);
  std::vector<double> distances;
  for (const Vec3& point : points) {
    const double distance = point.dot(direction);
    if (distance > least_cosine * point.norm()) distances.push_back(distance);
  }
  return distances;
}

std::optional<double> wallDistance(const std::vector<Vec3>& points, const Vec3& direction,
                                   const PassageOptions& options) {
  for (double cone_rad : {options.cone_rad, options.wide_cone_rad}) {
    std::vector<double> distances = distancesIn(points, direction, cone_rad);
    if (distances.size() < options.min_cone_points) continue;
    std::sort(distances.begin(), distances.end());
    return quantile(distances, options.share);
  }
  return std::nullopt;
}

std::vector<Vec3> chooseSplays(const std::vector<Vec3>& points, const PassageSection& section,
                               const PassageOptions& options) {
  std::vector<std::vector<Vec3>> sectors(options.splay_sectors);
  for (const Vec3& point : points) {
    const double angle = std::atan2(point.dot(section.above()), point.dot(section.left));
    const double turn = angle / (2.0 * std::numbers::pi) + 0.5;
    const auto sector = static_cast<size_t>(turn * static_cast<double>(sectors.size()));
    sectors[std::min(sector, sectors.size() - 1)].push_back(point);
  }
  std::vector<Vec3> splays;
  for (std::vector<Vec3>& sector : sectors) {
    if (sector.size() < options.min_sector_points) continue;
    const auto middle = sector.begin() + static_cast<std::ptrdiff_t>(sector.size() / 2);
    std::nth_element(sector.begin(), middle, sector.end(),
                     [](const Vec3& a, const Vec3& b) { return a.squaredNorm() < b.squaredNorm(); });
    splays.push_back(section.origin + *middle);
  }
  return splays;
}

}  // namespace

std::vector<PassageSection> passageSections(const std::vector<SurveyStation>& stations) {
  std::vector<PassageSection> sections(stations.size());
  Vec3 left = Vec3::UnitY();
  for (size_t i = 0; i < stations.size(); ++i) {
    const Vec3 along = directionAt(stations, i);
    left = leftOf(along, left);
    // Makes them orthogonal, also where `left` is that of an earlier station.
    const Vec3 horizontal = (left - left.dot(along) * along).normalized();
    sections[i] = {stations[i].position_ENU, along, horizontal};
  }
  return sections;
}

void measurePassage(const std::vector<Vec3>& walls_ENU, const PassageOptions& options, Survey* survey) {
  const std::vector<PassageSection> sections = passageSections(survey->stations);
  for (size_t i = 0; i < sections.size(); ++i) {
    const PassageSection& section = sections[i];
    const std::vector<Vec3> points = pointsAcross(walls_ENU, section, options);
    PassageSize& passage = survey->stations[i].passage;
    passage.left = wallDistance(points, section.left, options);
    passage.right = wallDistance(points, -section.left, options);
    passage.up = wallDistance(points, Vec3::UnitZ(), options);
    passage.down = wallDistance(points, -Vec3::UnitZ(), options);
    survey->stations[i].splays_ENU = chooseSplays(points, section, options);
  }
}

}  // namespace lodeline
