#include "lodeline/output/walls/section/cross_section.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lodeline {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Where a plane cuts the edge of a triangle; `a` and `b` are on different sides.
Vec2 crossing(const Vec2& a, const Vec2& b, double height_a, double height_b) {
  return a + height_a / (height_a - height_b) * (b - a);
}

/// Distances of points of the lines, one each centimetre, by sector.
std::vector<std::vector<double>> distancesBySector(const std::vector<SectionLine>& lines, size_t sectors) {
  constexpr double kStep_m = 0.01;
  std::vector<std::vector<double>> distances(sectors);
  for (const SectionLine& line : lines) {
    const int steps = std::max(1, static_cast<int>((line.to - line.from).norm() / kStep_m));
    for (int i = 0; i <= steps; ++i) {
      const Vec2 point = line.from + (line.to - line.from) * i / steps;
      distances[sectorOf(point, sectors)].push_back(point.norm());
    }
  }
  return distances;
}

double sectorArea_m2(double radius_m, size_t sectors) {
  return 0.5 * radius_m * radius_m * kTurn / static_cast<double>(sectors);
}

/// The radii with gaps filled from both sides; empty where a gap is too wide.
std::optional<std::vector<double>> filled(const std::vector<std::optional<double>>& radii, size_t max_gap) {
  const size_t count = radii.size();
  std::vector<double> result(count, 0.0);
  for (size_t i = 0; i < count; ++i) {
    if (radii[i]) {
      result[i] = *radii[i];
      continue;
    }
    size_t back = 1, ahead = 1;
    while (back <= max_gap && !radii[(i + count - back) % count]) ++back;
    while (ahead <= max_gap && !radii[(i + ahead) % count]) ++ahead;
    if (back + ahead - 1 > max_gap) return std::nullopt;
    const double share = static_cast<double>(back) / static_cast<double>(back + ahead);
    result[i] = (1.0 - share) * *radii[(i + count - back) % count] + share * *radii[(i + ahead) % count];
  }
  return result;
}

}  // namespace

SectionPlane planeAcross(const PassageSection& section) {
  return {section.origin, -section.left, section.above()};
}

SectionPlane verticalPlane(const PassageSection& section) {
  const Vec3 level = Vec3(section.left.x(), section.left.y(), 0.0).normalized();
  return {section.origin, -level, Vec3::UnitZ()};
}

void cutMesh(const WallMesh& mesh, const SectionPlane& plane, double reach_m,
             std::vector<SectionLine>* lines) {
  const Vec3 normal = plane.normal();
  std::vector<float> heights(mesh.vertices());
  for (size_t i = 0; i < heights.size(); ++i) {
    const double height = (mesh.positions[i].cast<double>() - plane.origin).dot(normal);
    heights[i] = static_cast<float>(height == 0.0 ? 1e-9 : height);  // no vertex lies in the plane
  }
  for (const auto& triangle : mesh.triangles) {
    std::array<Vec2, 2> ends;
    size_t count = 0;
    for (size_t edge = 0; edge < 3; ++edge) {
      const uint32_t a = triangle[edge], b = triangle[(edge + 1) % 3];
      if ((heights[a] > 0.0F) == (heights[b] > 0.0F) || count == 2) continue;
      ends[count++] = crossing(plane.inPlane(mesh.positions[a].cast<double>()),
                               plane.inPlane(mesh.positions[b].cast<double>()), heights[a], heights[b]);
    }
    if (count == 2 && std::max(ends[0].norm(), ends[1].norm()) <= reach_m)
      lines->push_back({ends[0], ends[1]});
  }
}

double SectionOutline::angle_rad(size_t sector) const {
  return kTurn * (static_cast<double>(sector) + 0.5) / static_cast<double>(radii_m.size());
}

std::optional<double> SectionOutline::towards(double angle_rad) const {
  constexpr double kHalfWidth_rad = 7.6 * std::numbers::pi / 180.0;
  std::vector<double> found;
  for (size_t i = 0; i < radii_m.size(); ++i) {
    const double off_rad = std::remainder(this->angle_rad(i) - angle_rad, kTurn);
    if (radii_m[i] && std::abs(off_rad) <= kHalfWidth_rad) found.push_back(*radii_m[i] * std::cos(off_rad));
  }
  if (found.empty()) return std::nullopt;
  std::sort(found.begin(), found.end());
  return quantile(found, 0.5);
}

size_t sectorOf(const Vec2& point, size_t sectors) {
  const double turn = std::atan2(point.y(), point.x()) / kTurn;
  const auto sector = static_cast<size_t>((turn < 0.0 ? turn + 1.0 : turn) * static_cast<double>(sectors));
  return std::min(sector, sectors - 1);
}

SectionOutline outlineOf(const std::vector<SectionLine>& lines, const SectionOptions& options) {
  // Walls up to this far behind the nearest point of a sector count as the same wall.
  constexpr double kSameWall_m = 0.3;
  std::vector<std::optional<double>> radii_m;
  for (std::vector<double>& distances : distancesBySector(lines, options.sectors)) {
    std::sort(distances.begin(), distances.end());
    radii_m.emplace_back();
    if (distances.empty()) continue;
    const auto end = std::upper_bound(distances.begin(), distances.end(), distances.front() + kSameWall_m);
    radii_m.back() = quantile({distances.begin(), end}, 0.5);
  }
  return outlineOf(std::move(radii_m), options);
}

SectionOutline outlineOf(std::vector<std::optional<double>> radii_m, const SectionOptions& options) {
  SectionOutline outline;
  outline.radii_m = std::move(radii_m);
  const auto known = std::count_if(outline.radii_m.begin(), outline.radii_m.end(),
                                   [](const std::optional<double>& radius) { return radius.has_value(); });
  outline.coverage = static_cast<double>(known) / static_cast<double>(outline.radii_m.size());
  for (const std::optional<double>& radius : outline.radii_m)
    outline.seen_area_m2 += sectorArea_m2(radius.value_or(0.0), outline.radii_m.size());
  if (outline.coverage < options.least_coverage) return outline;
  const auto radii = filled(outline.radii_m, options.max_gap_sectors);
  if (!radii) return outline;
  double area_m2 = 0.0;
  for (const double radius : *radii) area_m2 += sectorArea_m2(radius, radii->size());
  outline.area_m2 = area_m2;
  return outline;
}

}  // namespace lodeline
