#include "simulation/rendering/cave/cave_furniture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/rendering/cave/gradient_noise.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

using FreePlace = std::function<bool(const Vec3f&, float)>;

float uniform(Random& random, double low, double high) {
  return static_cast<float>(random.uniform(low, high));
}

/// Whether an object with a radius at a point near ring i stays outside the diver's corridor.
bool isClear(const CaveWalls& walls, const FreePlace& isFree, int i, const Vec3f& point, float margin_m,
             float radius_m) {
  if (isFree && !isFree(point, radius_m)) return false;
  const float spacing_m = std::max(0.01f, (walls.rings[1].center - walls.rings[0].center).norm());
  const int window = static_cast<int>((radius_m + 1.5f) / spacing_m) + 1;
  const int count = static_cast<int>(walls.rings.size());
  for (int step = -window; step <= window; ++step) {
    const int k = walls.closed ? ((i + step) % count + count) % count : i + step;
    if (k < 0 || k >= count) continue;
    const float along = walls.rings[k].forward.dot(point - walls.rings[k].center);
    if (std::abs(along) > radius_m + spacing_m) continue;
    if (!walls.rings[k].clearOfCorridor(point, margin_m + radius_m)) return false;
  }
  return true;
}

/// Vertex of ring i at an angle (rad from right to up).
const Vec3f& wallAt(const CaveWalls& walls, int i, float angle) {
  const float turns = angle / (2.0f * std::numbers::pi_v<float>);
  const int j = static_cast<int>(std::lround((turns - std::floor(turns)) * walls.ring_size));
  return walls.vertex(i, j % walls.ring_size);
}

void addBoulder(TriangleMesh& out, const Vec3f& position, float radius_m, const CaveStyle& style,
                Random& random) {
  TriangleMesh block = makeBoulder(random.next(), radius_m > 0.35f ? 4 : 3);
  const Mat3f turn = Eigen::Quaternionf(Eigen::AngleAxisf(uniform(random, 0.0, 6.28), Vec3f::UnitZ()) *
                                        Eigen::AngleAxisf(uniform(random, -0.5, 0.5), Vec3f::UnitX()))
                         .toRotationMatrix();
  const Vec3f scale(radius_m * uniform(random, 0.8, 1.3), radius_m * uniform(random, 0.7, 1.1),
                    radius_m * uniform(random, 0.5, 0.9));
  const float shade = uniform(random, 0.75, 1.25);
  for (size_t k = 0; k < block.positions.size(); ++k) {
    Vec3f& p = block.positions[k];
    p = position + turn * scale.cwiseProduct(p);
    // Silt settles on upward faces.
    const float dust = smoothStep(0.55f, 0.95f, block.normals[k].z());
    block.materials[k] = Material::of(lerp(style.rock_albedo * shade, style.sediment_albedo, 0.6f * dust),
                                      lerp(1.0f, 0.6f, dust));
  }
  block.computeNormals();
  out.append(block);
}

/// Adds a tapering cone from `root` over `length_m` along `down` (unit vertical), banded like grown calcite.
void addSpike(TriangleMesh& out, const Vec3f& root, const Vec3f& down, float length_m, float radius_m,
              float sharpness, float flare, const CaveStyle& style, uint64_t seed) {
  const int rows = std::clamp(static_cast<int>(length_m / 0.03f), 8, 60);
  const int columns = std::clamp(static_cast<int>(6.3f * radius_m / 0.02f), 10, 28);
  const uint32_t noise_seed = static_cast<uint32_t>(seed);
  TriangleMesh spike;
  for (int i = 0; i < rows; ++i) {
    const float t = static_cast<float>(i) / (rows - 1);
    // Wider at its root in the rock.
    const float taper =
        std::pow(std::max(0.0f, 1.0f - t), sharpness) + flare * std::exp(-t / 0.10f) * (1.0f - t);
    for (int j = 0; j < columns; ++j) {
      const float angle = 2.0f * std::numbers::pi_v<float> * j / columns;
      const Vec3f around(std::cos(angle), std::sin(angle), 0.0f);
      const Vec3f axis = root + down * ((t * 1.15f - 0.15f) * length_m);
      const Vec3f q = axis + radius_m * around;
      const float bulge =
          1.0f + 0.45f * fractalNoise(Vec3f(q.x() / 0.25f, q.y() / 0.25f, q.z() / 0.12f), 3, noise_seed) +
          0.25f * gradientNoise(Vec3f(0.0f, 0.0f, q.z() / 0.3f), noise_seed + 9);
      const float band = gradientNoise(Vec3f(angle, 0.0f, q.z() / 0.06f), noise_seed + 5);
      spike.addVertex(axis + radius_m * taper * bulge * around,
                      Material::of(style.flowstone_albedo * (0.95f + 0.25f * band), 0.45f, 0.5f));
    }
  }
  addGridTriangles(spike, 0, rows, columns, true);
  spike.computeNormals();
  out.append(spike);
}

void scatterBoulders(TriangleMesh& out, const CaveWalls& walls, const FreePlace& isFree,
                     const CaveStyle& style, uint64_t seed, float clearance_m, float length_m) {
  Random random(seed, "cave/boulders");
  const int count = static_cast<int>(style.boulders_per_m * length_m);
  for (int n = 0; n < count; ++n) {
    const int i = random.index(static_cast<int>(walls.rings.size()));
    // Blocks are in heaps; the floor of some stretches is free.
    const float heap = gradientNoise(walls.rings[i].center / 5.0f, static_cast<uint32_t>(seed) + 77);
    const float angle = uniform(random, -std::numbers::pi * 0.95, -std::numbers::pi * 0.05);
    const float size = style.largest_boulder_m * std::pow(uniform(random, 0.02, 1.0), 1.3f);
    const float radius = std::clamp(size, 0.08f, 0.35f * walls.rings[i].half_width_m + 0.05f);
    if (heap < -0.1f && radius > 0.15f) continue;
    const Vec3f position = wallAt(walls, i, angle) + 0.15f * radius * Vec3f::UnitZ();
    if (!isClear(walls, isFree, i, position, clearance_m, 1.3f * radius)) continue;
    addBoulder(out, position, radius, style, random);
  }
}

void hangStalactites(TriangleMesh& out, const CaveWalls& walls, const FreePlace& isFree,
                     const CaveStyle& style, uint64_t seed, float clearance_m, float length_m) {
  Random random(seed, "cave/stalactites");
  const int count = static_cast<int>(style.stalactites_per_m * length_m);
  for (int n = 0; n < count; ++n) {
    const int i = random.index(static_cast<int>(walls.rings.size()));
    const float cluster = gradientNoise(walls.rings[i].center / 4.0f, static_cast<uint32_t>(seed) + 78);
    const float angle = uniform(random, 0.35, std::numbers::pi - 0.35);
    const float length = 0.12f + 1.6f * std::pow(uniform(random, 0.0, 1.0), 2.5f);
    const float radius = length * uniform(random, 0.05, 0.11) + 0.01f;
    if (cluster < -0.15f) continue;
    const Vec3f root = wallAt(walls, i, angle);
    const Vec3f foot = wallAt(walls, i, -angle);
    const float gap = root.z() - foot.z();
    const auto clear = [&](const Vec3f& p) {
      return isClear(walls, isFree, i, p, clearance_m, 1.5f * radius);
    };
    const bool column = length > 0.7f * gap && clear(0.5f * (root + foot)) && clear(foot);
    const float drop = column ? 0.75f * gap : std::min(length, 0.45f * gap);
    const Vec3f tip = root - drop * Vec3f::UnitZ();
    if (isFree && !isFree(root, radius)) continue;
    if (!clear(tip) || !clear(0.5f * (root + tip))) continue;
    addSpike(out, root, -Vec3f::UnitZ(), drop, radius, 0.8f, 0.9f, style, random.next());
    const Vec3f under(root.x(), root.y(), foot.z());
    const float height = column ? 0.75f * gap : drop * uniform(random, 0.1, 0.6);
    if (random.chance(column ? 1.0 : 0.4) && clear(under + height * Vec3f::UnitZ())) {
      addSpike(out, under, Vec3f::UnitZ(), height, 1.5f * radius + 0.02f, 0.5f, 0.0f, style, random.next());
    }
  }
}

}  // namespace

TriangleMesh makeBoulder(uint64_t seed, int subdivisions) {
  Random random(seed, "cave/boulder");
  TriangleMesh block = unitIcosphere(subdivisions);
  std::vector<std::pair<Vec3f, float>> cuts;
  for (int k = 0; k < 11; ++k) {
    cuts.emplace_back(random.direction().cast<float>(), uniform(random, 0.55, 0.92));
  }
  const uint32_t noise_seed = static_cast<uint32_t>(random.next());
  for (Vec3f& p : block.positions) {
    float radius = 1.0f;
    for (const auto& [normal, distance] : cuts) {
      const float facing = normal.dot(p);
      if (facing > 0.0f) radius = std::min(radius, distance / facing);
    }
    radius += 0.10f * fractalNoise(p * 1.7f, 4, noise_seed, 0.6f);
    p *= radius;
  }
  block.computeNormals();
  return block;
}

TriangleMesh makeCaveFurniture(const CaveWalls& walls, const CaveStyle& style, uint64_t seed,
                               double clearance_m, const FreePlace& isFree) {
  TriangleMesh furniture;
  float length_m = 0.0f;
  for (size_t i = 1; i < walls.rings.size(); ++i) {
    length_m += (walls.rings[i].center - walls.rings[i - 1].center).norm();
  }
  if (walls.closed) length_m += (walls.rings.front().center - walls.rings.back().center).norm();
  const float clearance = static_cast<float>(clearance_m);
  scatterBoulders(furniture, walls, isFree, style, seed, clearance, length_m);
  hangStalactites(furniture, walls, isFree, style, seed, clearance, length_m);
  return furniture;
}

}  // namespace lodeline
