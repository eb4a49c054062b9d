#include "simulation/rendering/cave/cave_walls.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/rendering/cave/gradient_noise.h"

namespace lodeline {
namespace {

constexpr float kFinestCell_m = 0.04f;
constexpr float kWidening_m = 0.3f;  ///< space for the relief between wall and corridor
constexpr float kEndCap_m = 3.0f;    ///< length over which each end of the tube closes

/// Rings every `cell_m`; their frames are upright where the passage is not steep.
std::vector<WallRing> makeRings(const Centerline& centerline, double cell_m) {
  const double begin = centerline.beginArcLength(), end = centerline.endArcLength();
  const bool closed = centerline.closed();
  const int count = std::max(2, static_cast<int>(std::ceil((end - begin) / cell_m)) + (closed ? 0 : 1));
  std::vector<WallRing> rings(count);
  Vec3f right = Vec3f::UnitX();
  for (int i = 0; i < count; ++i) {
    const double s = begin + (end - begin) * i / (closed ? count : count - 1);
    const PassageStation station = centerline.at(s);
    WallRing& ring = rings[i];
    ring.center = station.position_W.cast<float>();
    ring.forward = station.tangent_W.cast<float>();
    const Vec3f level = ring.forward.cross(Vec3f::UnitZ());
    // In a shaft, "right" is undefined, so the previous direction is kept.
    if (level.norm() > 0.2f) right = level.normalized();
    ring.right = (right - right.dot(ring.forward) * ring.forward).normalized();
    ring.up = ring.right.cross(ring.forward);
    const float to_end = closed ? kEndCap_m : static_cast<float>(std::min(s - begin, end - s));
    const float taper = std::sqrt(std::min(1.0f, to_end / kEndCap_m + 1e-4f));
    ring.taper = taper;
    ring.half_width_m = 0.5f * static_cast<float>(station.width_m) * taper;
    ring.half_height_m = 0.5f * static_cast<float>(station.height_m) * taper;
  }
  return rings;
}

float corridorHalfWidth(const WallRing& ring) {
  return static_cast<float>(kCorridorShareOfHalfWidth) * ring.half_width_m +
         static_cast<float>(kCorridorSway_m);
}

float corridorHalfHeight(const WallRing& ring) {
  return static_cast<float>(kCorridorShareOfHalfHeight) * ring.half_height_m +
         static_cast<float>(kCorridorSway_m);
}

/// Radius of a superellipse of exponent 4 around the corridor with its clearance; it includes the corners of
/// the corridor.
float clearRadius(const WallRing& ring, float cosine, float sine, float clearance_m) {
  const float x = cosine / (corridorHalfWidth(ring) + clearance_m);
  const float y = sine / (corridorHalfHeight(ring) + clearance_m);
  return 1.06f / std::pow(x * x * x * x + y * y * y * y, 0.25f);
}

/// `radius` where it is well above `closest`, otherwise a smooth function of it that stays above.
float keptOutside(float closest, float radius) {
  constexpr float kSoft_m = 0.25f;
  const float gap = radius - closest;
  return closest + (gap > kSoft_m ? gap : kSoft_m * std::exp(gap / kSoft_m - 1.0f));
}

double meanPerimeter(const Centerline& centerline) {
  double sum = 0.0;
  for (const PassageStation& s : centerline.stations()) {
    // Ramanujan's first approximation of an ellipse's perimeter.
    const double a = 0.5 * s.width_m, b = 0.5 * s.height_m;
    sum += std::numbers::pi * (3.0 * (a + b) - std::sqrt((3.0 * a + b) * (a + 3.0 * b)));
  }
  return sum / static_cast<double>(centerline.stations().size());
}

/// Relief of rock broken along joints: blocks displaced by random amounts (-0.5..0.5), with grooves between
/// them.
float brokenRock(const Vec3f& q, uint32_t seed) {
  const CellDistances cell = cellNoise(q, seed);
  const float block = static_cast<float>(cell.nearest_id >> 8 & 255) / 255.0f - 0.5f;
  const float joint = smoothStep(0.0f, 0.14f, cell.second - cell.nearest);
  return block * joint + 0.35f * (1.0f - joint);
}

/// Displacement of the rock outwards from the smooth section at a point on it, m.
float displacement(const Vec3f& q, float radius_m, const CaveStyle& style, uint32_t seed) {
  const float wavelength = std::max(2.0f, 1.6f * radius_m);
  const float alcove = fractalNoise(q / wavelength, 2, seed + 1);
  // Beds of different hardness: noise stretched along the horizontal, sharpened into ledges.
  const Vec3f bedded(q.x() / 5.0f, q.y() / 5.0f, q.z() / 0.55f + 0.4f * gradientNoise(q / 3.0f, seed + 2));
  const float bed = gradientNoise(bedded, seed + 3) + 0.5f * gradientNoise(2.3f * bedded, seed + 4);
  const float ledge = bed / (0.3f + std::abs(bed));
  const Vec3f warp(gradientNoise(q / 1.1f, seed + 5), gradientNoise(q / 1.1f, seed + 6),
                   gradientNoise(q / 1.1f, seed + 7));
  const Vec3f warped = q + 0.25f * warp;
  const float crags = fractalNoise(warped / 1.1f, 5, seed + 8, 0.58f);
  return 0.28f * std::min(radius_m, 3.0f) * alcove * (alcove > 0.0f ? 1.5f : 0.8f) + style.ledge_m * ledge +
         0.30f * crags + 0.24f * brokenRock(warped / 0.85f, seed + 9) +
         0.09f * brokenRock(warped / 0.30f, seed + 10);
}

/// Height (world z, m) of the silt at a point of the ring.
float sedimentLevel(const WallRing& ring, const Vec3f& q, const CaveStyle& style, float clearance_m,
                    uint32_t seed) {
  const float dunes = fractalNoise(Vec3f(q.x(), q.y(), 0.0f) / 4.0f, 2, seed + 20);
  const float ripples = gradientNoise(Vec3f(q.x() / 0.35f, q.y() / 0.35f, 0.0f), seed + 21);
  // Where there is little fill, the floor is bare rock.
  const float fill = style.sediment_fill + 0.22f * gradientNoise(ring.center / 9.0f, seed + 22);
  const float level = ring.half_height_m * (-1.0f + 2.0f * fill) + 0.22f * dunes;
  return ring.center.z() + std::min(level, -corridorHalfHeight(ring) - clearance_m) + 0.012f * ripples;
}

Material rockMaterial(const Vec3f& q, const CaveStyle& style, uint32_t seed) {
  const float bed = gradientNoise(Vec3f(q.x() / 7.0f, q.y() / 7.0f, q.z() / 0.4f), seed + 30);
  const float patches = fractalNoise(q / 2.2f, 3, seed + 31);
  // Dark mineral coating on part of the walls.
  const float coating = smoothStep(0.10f, 0.45f, patches);
  const float albedo = style.rock_albedo * (1.0f + 0.35f * bed + 0.3f * patches) * (1.0f - 0.45f * coating);
  // For noise of RMS 0.3, this threshold gives about the wanted fraction.
  const float bare = fractalNoise(q / 3.1f, 2, seed + 32);
  const float threshold = 0.42f - 0.9f * style.bare_share;
  const float flowstone = style.bare_share > 0.0f ? smoothStep(threshold, threshold + 0.12f, bare) : 0.0f;
  return Material::of(lerp(albedo, style.flowstone_albedo, flowstone), lerp(1.0f, 0.12f, flowstone),
                      0.5f * flowstone);
}

Material sedimentMaterial(const Vec3f& q, const CaveStyle& style, uint32_t seed) {
  const float patches = fractalNoise(q / 1.4f, 3, seed + 40);
  const float bare = smoothStep(0.25f - 0.8f * style.bare_share, 0.45f, gradientNoise(q / 3.5f, seed + 41));
  return Material::of(style.sediment_albedo * (1.0f + 0.25f * patches), lerp(0.55f, 0.10f, bare));
}

void placeVertex(CaveWalls& walls, int i, int j, const CaveStyle& style, float clearance_m, uint32_t seed) {
  const WallRing& ring = walls.rings[i];
  const float angle = 2.0f * std::numbers::pi_v<float> * j / walls.ring_size;
  const float cosine = std::cos(angle), sine = std::sin(angle);
  // Superellipse of exponent 2.5: flatter roof and walls than an ellipse.
  const float radius = std::pow(std::pow(std::abs(cosine) / ring.half_width_m, 2.5f) +
                                    std::pow(std::abs(sine) / ring.half_height_m, 2.5f),
                                -0.4f);
  const Vec3f outward = cosine * ring.right + sine * ring.up;
  const Vec3f base = ring.center + radius * outward;
  // Near the closed ends, the section is too small for the full relief.
  const float relief = std::min(1.0f, radius);
  const float moved = radius + relief * (kWidening_m + displacement(base, radius, style, seed));
  const float closest = std::max(0.6f * radius, ring.taper * clearRadius(ring, cosine, sine, clearance_m));
  const float outer = keptOutside(closest, moved);
  Vec3f position = ring.center + outer * outward;
  Material material = rockMaterial(position, style, seed);
  if (sine < 0.0f && position.z() < sedimentLevel(ring, position, style, clearance_m, seed)) {
    // The line from the centre intersects the silt before the rock. The level varies slowly, so three steps
    // suffice.
    for (int step = 0; step < 3; ++step) {
      const float drop = ring.center.z() - sedimentLevel(ring, position, style, clearance_m, seed);
      const float reach = std::min(outer, drop / std::max(0.02f, -outward.z()));
      position = ring.center + reach * outward;
    }
    material = sedimentMaterial(position, style, seed);
  }
  const size_t index = static_cast<size_t>(i) * walls.ring_size + j;
  walls.mesh.positions[index] = position;
  walls.mesh.materials[index] = material;
}

}  // namespace

bool WallRing::clearOfCorridor(const Vec3f& point, float margin_m) const {
  const Vec3f offset = point - center;
  return std::abs(offset.dot(right)) > corridorHalfWidth(*this) + margin_m ||
         std::abs(offset.dot(up)) > corridorHalfHeight(*this) + margin_m;
}

CaveWalls makeCaveWalls(const Centerline& centerline, const CaveStyle& style, uint64_t seed,
                        double clearance_m, size_t max_triangles) {
  const double length = centerline.endArcLength() - centerline.beginArcLength();
  const double perimeter = meanPerimeter(centerline);
  // Displacement lengthens the rings by about a third.
  const double cell_m = std::max<double>(
      kFinestCell_m, std::sqrt(2.0 * 1.3 * length * perimeter / static_cast<double>(max_triangles)));
  CaveWalls walls;
  walls.closed = centerline.closed();
  walls.rings = makeRings(centerline, cell_m);
  walls.ring_size = std::max(12, static_cast<int>(std::lround(1.3 * perimeter / cell_m)));
  const int count = static_cast<int>(walls.rings.size());
  walls.mesh.positions.resize(static_cast<size_t>(count) * walls.ring_size);
  walls.mesh.materials.resize(walls.mesh.positions.size());
  tbb::parallel_for(0, count, [&](int i) {
    for (int j = 0; j < walls.ring_size; ++j) {
      placeVertex(walls, i, j, style, static_cast<float>(clearance_m), static_cast<uint32_t>(seed));
    }
  });
  addGridTriangles(walls.mesh, 0, count, walls.ring_size, true);
  if (walls.closed) {
    joinRows(walls.mesh, static_cast<uint32_t>((count - 1) * walls.ring_size), 0, walls.ring_size);
  } else {
    // The end rings shrink to a point and close the tube.
    for (int j = 0; j < walls.ring_size; ++j) {
      walls.mesh.positions[j] = walls.rings.front().center;
      walls.mesh.positions[walls.mesh.positions.size() - 1 - j] = walls.rings.back().center;
    }
  }
  walls.mesh.computeNormals();
  return walls;
}

}  // namespace lodeline
