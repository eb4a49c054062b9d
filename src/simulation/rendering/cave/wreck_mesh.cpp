#include "simulation/rendering/cave/wreck_mesh.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "simulation/rendering/cave/cave_furniture.h"
#include "simulation/rendering/cave/gradient_noise.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

using PointOn = std::function<Vec3f(float u, float v)>;
using HoleAt = std::function<bool(float u, float v)>;

/// Material of the ship: rust under growth, with lumps of centimetres, pale and dark patches.
Material rustMaterial(const Vec3f& p, uint32_t seed) {
  const float growth = fractalNoise(p / 0.9f, 3, seed + 1);
  return Material::of(0.30f * (1.0f + 0.7f * growth), 1.0f);
}

Vec3f overgrown(const Vec3f& p, uint32_t seed) {
  const Vec3f q = p / 0.35f;
  return p + 0.05f * Vec3f(fractalNoise(q, 4, seed + 2), fractalNoise(q, 4, seed + 3),
                           fractalNoise(q, 4, seed + 4));
}

/// Adds an overgrown sheet over u, v in 0..1 with cells of about `cell_m`; cells in holes are left out.
void addSheet(TriangleMesh& out, const PointOn& point, const HoleAt& hole, float length_u_m, float length_v_m,
              uint32_t seed, float cell_m = 0.07f) {
  const int rows = std::max(2, static_cast<int>(length_u_m / cell_m)) + 1;
  const int columns = std::max(2, static_cast<int>(length_v_m / cell_m)) + 1;
  TriangleMesh sheet;
  std::vector<bool> open;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const float u = static_cast<float>(i) / (rows - 1), v = static_cast<float>(j) / (columns - 1);
      const Vec3f p = point(u, v);
      sheet.addVertex(overgrown(p, seed), rustMaterial(p, seed));
      open.push_back(hole && hole(u, v));
    }
  }
  addGridTriangles(sheet, 0, rows, columns, false);
  std::erase_if(sheet.triangles, [&](const auto& t) { return open[t[0]] || open[t[1]] || open[t[2]]; });
  sheet.computeNormals();
  out.append(sheet);
}

/// Size of a ship relative to the small one, along x, y and z.
Vec3f growthOf(const HullShape& hull) {
  const HullShape small;
  return {hull.half_length_m / small.half_length_m, hull.half_beam_m / small.half_beam_m,
          hull.depth_m / small.depth_m};
}

void addHull(TriangleMesh& ship, const HullShape& hull, uint32_t seed) {
  const PointOn point = [&](float u, float v) { return hull.point(u, v); };
  const auto brokenOff = [&](float u) { return u < hull.open_share || u > 1.0f - hull.open_share; };
  const HoleAt rusted_through = [&](float u, float v) {
    const Vec3f p = hull.point(u, v);
    return brokenOff(u) || (fractalNoise(p / 2.3f, 3, seed + 11) > 0.62f && p.z() > 0.4f);
  };
  // The girth is 11 m for the small ship.
  addSheet(ship, point, rusted_through, 2.0f * hull.half_length_m, 11.0f * growthOf(hull).y(), seed);
  const PointOn deck = [&](float u, float v) {
    const Vec3f rail = hull.point(u, 0.0f);
    return Vec3f(rail.x(), rail.y() * (1.0f - 2.0f * v) * 0.98f, rail.z() - 0.5f);
  };
  const HoleAt hatches = [&](float u, float v) {
    return brokenOff(u) || (v > 0.3f && v < 0.7f && ((u > 0.28f && u < 0.42f) || (u > 0.52f && u < 0.64f)));
  };
  addSheet(ship, deck, hatches, 2.0f * hull.half_length_m, 2.0f * hull.half_beam_m, seed + 20);
}

/// Adds four walls and a roof, optionally with windows.
void addBox(TriangleMesh& ship, const Vec3f& low, const Vec3f& size, bool windows, uint32_t seed) {
  const Vec3f x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  const HoleAt panes = [](float u, float v) {
    const float pane = 3.0f * u - std::floor(3.0f * u);
    return pane > 0.25f && pane < 0.8f && v > 0.5f && v < 0.82f;
  };
  const HoleAt hole = windows ? panes : HoleAt();
  const auto wall = [&](const Vec3f& corner, const Vec3f& along, uint32_t offset) {
    addSheet(
        ship, [=](float u, float v) { return Vec3f(corner + u * along + v * z); }, hole, along.norm(),
        z.norm(), seed + offset);
  };
  wall(low, x, 30);
  wall(low + y, x, 31);
  wall(low, y, 32);
  wall(low + x, y, 33);
  addSheet(
      ship, [&](float u, float v) { return Vec3f(low + z + u * x + v * y); }, HoleAt(), x.norm(), y.norm(),
      seed + 34);
}

void addTube(TriangleMesh& ship, const Vec3f& from, const Vec3f& to, float radius_m, uint32_t seed) {
  const Vec3f axis = (to - from).normalized();
  const Vec3f side =
      axis.cross(std::abs(axis.z()) < 0.9f ? Vec3f(Vec3f::UnitZ()) : Vec3f(Vec3f::UnitX())).normalized();
  const Vec3f other = axis.cross(side);
  const PointOn point = [=](float u, float v) {
    const float angle = 2.0f * std::numbers::pi_v<float> * v;
    return Vec3f(from + u * (to - from) + radius_m * (std::cos(angle) * side + std::sin(angle) * other));
  };
  addSheet(ship, point, HoleAt(), (to - from).norm(), 6.3f * radius_m, seed, 0.05f);
}

void addSuperstructure(TriangleMesh& ship, const HullShape& hull, uint32_t seed) {
  const float deck = hull.depth_m - hull.sunk_m - 0.5f;
  // Farther aft and higher than on the small ship.
  const float aft = 9.0f * (growthOf(hull).x() - 1.0f), rise = hull.depth_m - HullShape().depth_m;
  addBox(ship, {-9.0f - aft, -1.8f, deck}, {4.0f, 3.6f, 2.3f}, true, seed + 40);
  addBox(ship, {-8.4f - aft, -1.3f, deck + 2.3f}, {2.2f, 2.6f, 1.7f}, true, seed + 50);
  addTube(ship, {1.2f, 0.0f, deck}, {1.5f, 0.3f, 8.0f + rise}, 0.14f, seed + 60);
  addTube(ship, {1.4f, 0.2f, 5.0f + rise}, {5.6f, 1.9f, 3.6f + rise}, 0.08f, seed + 61);
  addTube(ship, {-6.8f - aft, 0.6f, deck + 4.0f}, {-6.8f - aft, 0.6f, deck + 5.6f}, 0.35f, seed + 62);
  for (int k = 0; k < 9; ++k) {
    // Rail posts.
    const Vec3f foot = hull.point(0.2f + 0.08f * k, k % 2 == 0 ? 0.0f : 1.0f);
    addTube(ship, foot - 0.2f * Vec3f::UnitZ(), foot + 0.9f * Vec3f::UnitZ(), 0.04f, seed + 70 + k);
  }
}

float seabedLevel(float x, float y, uint32_t seed) {
  const Vec3f p(x, y, 0.0f);
  const float ripples = std::sin(2.0f * x + 1.1f * y + 3.0f * gradientNoise(p / 3.0f, seed + 80));
  return 0.55f * fractalNoise(p / 9.0f, 3, seed + 81) + 0.035f * ripples;
}

void addSeabed(TriangleMesh& out, float half_m, uint32_t seed) {
  constexpr float kCell_m = 0.12f;
  const int side = static_cast<int>(2.0f * half_m / kCell_m) + 1;
  TriangleMesh bed;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const float x = -half_m + 2.0f * half_m * j / (side - 1), y = -half_m + 2.0f * half_m * i / (side - 1);
      const float patches = fractalNoise(Vec3f(x, y, 0.0f) / 2.5f, 3, seed + 82);
      bed.addVertex({x, y, seabedLevel(x, y, seed)}, Material::of(0.40f * (1.0f + 0.45f * patches), 0.75f));
    }
  }
  addGridTriangles(bed, 0, side, side, false);
  bed.computeNormals();
  out.append(bed);
}

void scatterDebris(TriangleMesh& out, const HullShape& hull, uint64_t seed) {
  Random random(seed, "wreck/debris");
  const Vec3f growth = growthOf(hull);
  const uint32_t noise_seed = static_cast<uint32_t>(seed);
  for (int k = 0; k < 90; ++k) {
    const float angle = static_cast<float>(random.uniform(0.0, 2.0 * std::numbers::pi));
    const float reach = static_cast<float>(random.uniform(1.05, 2.4));
    const float x = 13.0f * growth.x() * reach * std::cos(angle);
    const float y = 5.5f * growth.y() * reach * std::sin(angle);
    const float size = 0.12f + 0.6f * std::pow(static_cast<float>(random.uniform()), 2.0f);
    const Vec3f place(x, y, seabedLevel(x, y, noise_seed));
    if (k % 6 == 0) {
      addBox(out, place - Vec3f(0, 0, 0.1f), Vec3f(1.2f, 0.9f, 0.8f) * (0.5f + size), false,
             noise_seed + 90 + k);
      continue;
    }
    TriangleMesh block = makeBoulder(random.next(), size > 0.4f ? 4 : 3);
    for (size_t n = 0; n < block.positions.size(); ++n) {
      block.positions[n] = place + size * block.positions[n].cwiseProduct(Vec3f(1.0f, 0.9f, 0.7f));
      block.materials[n] = Material::of(0.34f, 1.0f);
    }
    block.computeNormals();
    out.append(block);
  }
}

}  // namespace

Vec3f HullShape::point(float u, float v) const {
  const float along = 2.0f * u - 1.0f;
  const float fullness =
      std::pow(std::max(0.0f, 1.0f - std::pow(std::abs(along), along > 0.0f ? 2.2f : 5.0f)), 0.6f);
  const float angle = std::numbers::pi_v<float> * v;
  const float cosine = std::cos(angle);
  const float beam = half_beam_m * (0.05f + 0.95f * fullness);
  // Flat bottom and round bilge as a superellipse.
  const float across = -beam * (cosine < 0.0f ? -1.0f : 1.0f) * std::pow(std::abs(cosine), 0.6f);
  const float sheer = 0.8f * along * along * (along > 0.0f ? 1.0f : 0.4f);
  const float height = (depth_m + sheer) * (1.0f - std::pow(std::sin(angle), 0.5f)) - sunk_m;
  // Plates overlap by their thickness.
  const float seam = 0.015f * std::floor(v * 14.0f - std::floor(v * 14.0f) + 0.5f);
  return {half_length_m * along, across * (1.0f + 0.01f * seam), height + seam};
}

TriangleMesh makeWreck(const WreckOptions& options) {
  const uint32_t seed = static_cast<uint32_t>(options.seed);
  TriangleMesh mesh;
  addHull(mesh, options.hull, seed);
  addSuperstructure(mesh, options.hull, seed);
  const Mat3f list = Eigen::AngleAxisf(options.list_rad, Vec3f::UnitX()).toRotationMatrix();
  for (Vec3f& p : mesh.positions) p = list * p;
  for (Vec3f& n : mesh.normals) n = list * n;
  scatterDebris(mesh, options.hull, options.seed);
  addSeabed(mesh, options.seabed_half_m, seed);
  const Mat3f turn = Eigen::AngleAxisf(options.heading_rad, Vec3f::UnitZ()).toRotationMatrix();
  for (Vec3f& p : mesh.positions) p = options.center_W + turn * p;
  for (Vec3f& n : mesh.normals) n = turn * n;
  return mesh;
}

}  // namespace lodeline
