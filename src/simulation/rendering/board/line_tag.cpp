#include "simulation/rendering/board/line_tag.h"

#include <array>
#include <cmath>

#include "lodeline/board/tag_family.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

constexpr double kSize_m = 0.15;
// A white margin of one and a half cells of the eight.
constexpr double kPlateShare = 1.0 + 3.0 / 8.0;
// The walls keep 0.4 m from the corridor, the plate has a half diagonal of 0.15 m.
constexpr double kOutside_m = 0.2;
constexpr double kThickness_m = 0.008;
// Matte grey, as bright as the rock: a white plate is overexposed next to rock, and its light spills over the
// black square by more than a pixel.
constexpr float kPlateAlbedo = 0.42f;

Rigid3 poseAt(const PassageStation& station, Random& random) {
  const double side = random.sign(), up_share = random.uniform(-0.5, 0.4);
  const Vec3 left = Vec3::UnitZ().cross(station.tangent_W).normalized();
  const double across_m =
      side * (0.5 * kCorridorShareOfHalfWidth * station.width_m + kCorridorSway_m + kOutside_m);
  const double above_m = 0.5 * up_share * kCorridorShareOfHalfHeight * station.height_m;
  // Towards the diver who comes, and a little towards the middle.
  const Vec3 out = (-station.tangent_W - 0.4 * side * left).normalized();
  const Vec3 right = Vec3::UnitZ().cross(out).normalized();
  Mat3 axes;
  axes << right, out.cross(right), out;
  const Quat askew = so3::exp(8.0 * kDegree * random.normal3());
  return Rigid3((Quat(axes) * askew).normalized(),
                station.position_W + across_m * left + above_m * Vec3::UnitZ());
}

}  // namespace

Vec3 LineTag::corner_C(int k) const {
  const double half_m = 0.5 * size_m;
  return cave_from_tag * Vec3(k == 0 || k == 3 ? -half_m : half_m, k < 2 ? -half_m : half_m, 0.0);
}

std::vector<LineTag> placeTags(const CaveLayout& cave, const std::vector<LinedStretch>& line, int count,
                               uint64_t seed) {
  double length_m = 0.0;
  for (const LinedStretch& stretch : line) length_m += stretch.to_m - stretch.from_m;
  Random random(seed, "line/tags");
  std::vector<LineTag> tags;
  for (int id = 0; id < count; ++id) {
    double along_m = length_m * (id + random.uniform(0.3, 0.7)) / count;
    size_t k = 0;
    while (k + 1 < line.size() && along_m > line[k].to_m - line[k].from_m) {
      along_m -= line[k].to_m - line[k].from_m;
      ++k;
    }
    const PassageStation station =
        cave.passages[static_cast<size_t>(line[k].passage)].at(line[k].from_m + along_m);
    tags.push_back({id, kSize_m, poseAt(station, random)});
  }
  return tags;
}

TriangleMesh makeTagMesh(const std::vector<LineTag>& tags) {
  TriangleMesh mesh;
  for (const bool front : {true, false}) {
    for (const LineTag& tag : tags) {
      const double half_m = 0.5 * kPlateShare * tag.size_m;
      addRectangle(front ? Vec3(Vec3::Zero()) : Vec3(0.0, 0.0, -kThickness_m), half_m, half_m,
                   Material::of(front ? kPlateAlbedo : 0.25f, 0.0f), tag.cave_from_tag, &mesh);
    }
  }
  mesh.computeNormals();
  return mesh;
}

PrintedPanel tagPanel(const LineTag& tag, const Vec3& cave_origin_W) {
  constexpr int kCells = 8;
  const TagFamily family(1);
  std::array<bool, kCells * kCells> black{};
  for (int row = 0; row < kCells; ++row) {
    for (int column = 0; column < kCells; ++column)
      black[static_cast<size_t>(row * kCells + column)] = family.isBlack(tag.id, column, row);
  }
  const double size_m = tag.size_m;
  const auto isBlack = [black, size_m](double x_m, double y_m) {
    const int column = static_cast<int>(std::floor((x_m / size_m + 0.5) * kCells));
    const int row = static_cast<int>(std::floor((0.5 - y_m / size_m) * kCells));
    return column >= 0 && row >= 0 && column < kCells && row < kCells &&
           black[static_cast<size_t>(row * kCells + column)];
  };
  return {Rigid3(tag.cave_from_tag.rotation, tag.cave_from_tag.translation + cave_origin_W), isBlack};
}

}  // namespace lodeline
