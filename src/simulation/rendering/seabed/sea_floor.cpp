#include "simulation/rendering/seabed/sea_floor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/rendering/cave/cave_furniture.h"
#include "simulation/rendering/cave/gradient_noise.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

constexpr float kSand = 0.40f, kRock = 0.30f;

void addStone(const SeaFloor& floor, float x, float y, float size_m, Random& random, TriangleMesh& out) {
  TriangleMesh stone = makeBoulder(random.next(), size_m > 0.3f ? 4 : size_m > 0.1f ? 3 : 2);
  const float turn_rad = static_cast<float>(random.uniform(0.0, 2.0 * std::numbers::pi));
  const Mat3f turn = Eigen::AngleAxisf(turn_rad, Vec3f::UnitZ()).toRotationMatrix();
  const Vec3f shape(static_cast<float>(random.uniform(0.8, 1.3)),
                    static_cast<float>(random.uniform(0.7, 1.0)),
                    static_cast<float>(random.uniform(0.45, 0.8)));
  const float albedo = static_cast<float>(random.uniform(0.20, 0.50));
  const Vec3f place(x, y, floor.height_m(x, y) + 0.2f * size_m);
  for (size_t k = 0; k < stone.positions.size(); ++k) {
    stone.positions[k] = place + size_m * (turn * shape.cwiseProduct(stone.positions[k]));
    stone.materials[k] = Material::of(albedo, 1.0f);
  }
  stone.computeNormals();
  out.append(stone);
}

void scatterStones(const SeaFloor& floor, const SeaFloorOptions& o, TriangleMesh& out) {
  Random random(o.seed, "sea-floor/stones");
  const double area_m2 = (o.high_F.x() - o.low_F.x()) * (o.high_F.y() - o.low_F.y());
  const auto scatter = [&](double per_m2, double least_m, double most_m) {
    for (int k = static_cast<int>(per_m2 * area_m2); k > 0; --k) {
      const auto x = static_cast<float>(random.uniform(o.low_F.x(), o.high_F.x()));
      const auto y = static_cast<float>(random.uniform(o.low_F.y(), o.high_F.y()));
      // Most stones are small.
      const double share = std::pow(random.uniform(), 3.0);
      addStone(floor, x, y, static_cast<float>(least_m + (most_m - least_m) * share), random, out);
    }
  };
  scatter(0.08, 0.15, 0.60);
  scatter(2.0, 0.025, 0.12);
}

}  // namespace

float SeaFloor::rockShare(float x, float y) const {
  return smoothStep(0.05f, 0.40f, fractalNoise(Vec3f(x, y, 0.0f) / 5.0f, 3, seed_));
}

float SeaFloor::height_m(float x, float y) const {
  const Vec3f p(x, y, 0.0f);
  const float dunes =
      0.50f * fractalNoise(p / 14.0f, 2, seed_ + 10) + 0.12f * gradientNoise(p / 3.1f, seed_ + 11);
  const float rock = rockShare(x, y);
  const float crags =
      0.22f * (1.0f + ridgedNoise(p / 1.6f, 3, seed_ + 12)) + 0.03f * fractalNoise(p / 0.3f, 2, seed_ + 13);
  // Crests of ripples bend and fork.
  const float phase = 22.0f * x + 9.0f * y + 5.0f * fractalNoise(p / 2.2f, 2, seed_ + 14);
  const float ripples = 0.035f * (1.0f - std::abs(std::sin(0.5f * phase)));
  return dunes + rock * crags + (1.0f - rock) * ripples;
}

Material SeaFloor::materialAt(float x, float y) const {
  const Vec3f p(x, y, 0.0f);
  const float rock = rockShare(x, y);
  const float patches = fractalNoise(p / 1.3f, 4, seed_ + 15);
  // Growth on rock, silt and shells on sand.
  const float growth = fractalNoise(p / 0.35f, 3, seed_ + 16);
  const float sand = kSand * (1.0f + 0.35f * patches);
  const float stone = kRock * (1.0f + 0.6f * growth);
  return Material::of(sand + rock * (stone - sand), 0.7f + 0.3f * rock);
}

TriangleMesh makeSeaFloor(const SeaFloorOptions& o) {
  const SeaFloor floor(o.seed);
  const Vec3f size = o.high_F - o.low_F;
  const int rows = std::max(2, static_cast<int>(size.y() / o.cell_m)) + 1;
  const int columns = std::max(2, static_cast<int>(size.x() / o.cell_m)) + 1;
  TriangleMesh mesh;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const float x = o.low_F.x() + size.x() * static_cast<float>(j) / static_cast<float>(columns - 1);
      const float y = o.low_F.y() + size.y() * static_cast<float>(i) / static_cast<float>(rows - 1);
      mesh.addVertex({x, y, floor.height_m(x, y)}, floor.materialAt(x, y));
    }
  }
  addGridTriangles(mesh, 0, rows, columns, false);
  mesh.computeNormals();
  scatterStones(floor, o, mesh);
  for (Vec3f& p : mesh.positions) p += o.origin_W;
  return mesh;
}

}  // namespace lodeline
