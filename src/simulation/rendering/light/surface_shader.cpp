#include "simulation/rendering/light/surface_shader.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lodeline {
namespace {

// Tile sizes for near rock and for the width of a passage. They are incommensurate, so that repetitions do
// not coincide. Larger structures are in the vertices' materials.
constexpr int kTiles = 2;
constexpr float kTile_m[kTiles] = {0.43f, 2.1f};
constexpr float kTileContrast[kTiles] = {0.62f, 0.60f};
constexpr float kTileRelief[kTiles] = {0.75f, 0.55f};

// Light reflected by more than one wall, as a fraction of the direct light at a place. It arrives from all
// directions and has no shadows. For walls of albedo 0.35 that fill half the view, 0.35 * 0.5 * 0.35 = 0.06.
constexpr float kIndirectShare = 0.06f;

/// Rotates the larger tile relative to the smaller one, so that their lattices do not align.
Vec3f turned(const Vec3f& p) {
  return {0.80f * p.x() + 0.60f * p.y(), -0.48f * p.x() + 0.64f * p.y() + 0.60f * p.z(),
          0.36f * p.x() - 0.48f * p.y() + 0.80f * p.z()};
}

Vec3f turnedBack(const Vec3f& p) {
  return {0.80f * p.x() - 0.48f * p.y() + 0.36f * p.z(), 0.60f * p.x() + 0.64f * p.y() - 0.48f * p.z(),
          0.60f * p.y() + 0.80f * p.z()};
}

}  // namespace

void SurfaceShader::describe(const RayPacket& rays, const HitPacket& hits, int i, float pixel_angle_rad,
                             bool detail, const LightField& light, Lit& lit) const {
  const Vec3f view = rays.directionOf(i);
  const Vec3f point = rays.originOf(i) + hits.range_m[i] * view;
  const SurfacePoint base =
      hits.body[i] >= 0 ? light.bodies[hits.body[i]].surfaceAt(point) : scene_.surfaceAt(hits, i);
  const float facing = -base.normal.dot(view);
  Vec3f normal = facing < 0.0f ? Vec3f(-base.normal) : base.normal;
  float reflectance = base.reflectance;
  if (detail) {
    // At grazing incidence, a pixel covers a long strip, whose width is taken as the geometric mean of its
    // axes. An additional third keeps the remaining texture well sampled.
    const float footprint =
        1.35f * hits.range_m[i] * pixel_angle_rad / std::sqrt(std::max(0.08f, std::abs(facing)));
    const Vec3f place = point - texture_origin_W_;
    const TextureSample fine = texture_.sample(place, kTile_m[0], footprint);
    const TextureSample coarse = texture_.sample(turned(place), kTile_m[1], footprint);
    const float shade = kTileContrast[0] * fine.reflectance + kTileContrast[1] * coarse.reflectance;
    reflectance *= std::clamp(1.0f + base.contrast * shade, 0.12f, 2.4f);
    // A relief h on the surface tilts its normal by minus the tangential part of h's gradient (J. Blinn,
    // "Simulation of wrinkled surfaces", SIGGRAPH 1978).
    const Vec3f slope =
        base.contrast * (kTileRelief[0] * fine.slope + kTileRelief[1] * turnedBack(coarse.slope));
    normal = (normal - (slope - slope.dot(normal) * normal)).normalized();
  }
  for (int axis = 0; axis < 3; ++axis) {
    lit.point[axis][i] = point[axis];
    lit.normal[axis][i] = normal[axis];
  }
  lit.reflectance[i] = reflectance;
  lit.gloss[i] = base.gloss;
}

void SurfaceShader::addLamp(const RayPacket& rays, const Lit& lit, const PlacedLamp& lamp,
                            const LightField& light, float* radiance) const {
  const float attenuation = light.water.mean().diffuse_attenuation;
  float towards[3][kRayPacketSize], distance[kRayPacketSize], direct[kRayPacketSize];
  for (int i = 0; i < kRayPacketSize; ++i) {
    const float x = lamp.position().x() - lit.point[0][i];
    const float y = lamp.position().y() - lit.point[1][i];
    const float z = lamp.position().z() - lit.point[2][i];
    distance[i] = std::sqrt(std::max(0.0025f, x * x + y * y + z * z));
    const float per_distance = 1.0f / distance[i];
    towards[0][i] = x * per_distance;
    towards[1][i] = y * per_distance;
    towards[2][i] = z * per_distance;
    const float arriving = lamp.irradiance(Vec3f(towards[0][i], towards[1][i], towards[2][i]), distance[i]) *
                           fastExp(-attenuation * distance[i]);
    const float cosine = std::max(0.0f, lit.normal[0][i] * towards[0][i] + lit.normal[1][i] * towards[1][i] +
                                            lit.normal[2][i] * towards[2][i]);
    // Blinn-Phong's broad highlight (SIGGRAPH 1977), exponent 32.
    const float hx = towards[0][i] - rays.direction[0][i];
    const float hy = towards[1][i] - rays.direction[1][i];
    const float hz = towards[2][i] - rays.direction[2][i];
    const float aligned = lit.normal[0][i] * hx + lit.normal[1][i] * hy + lit.normal[2][i] * hz;
    const float a2 = aligned * aligned / std::max(1e-6f, hx * hx + hy * hy + hz * hz);
    const float a4 = a2 * a2, a8 = a4 * a4, a16 = a8 * a8;
    radiance[i] += kIndirectShare * lit.reflectance[i] * arriving;
    direct[i] = arriving * (lit.reflectance[i] * cosine + 0.35f * lit.gloss[i] * a16 * a16);
  }
  RayPacket shadow;
  for (int i = 0; i < kRayPacketSize; ++i) {
    // An invisible contribution needs no shadow.
    if (direct[i] <= 0.02f * radiance[i]) {
      shadow.disable(i);
      continue;
    }
    // Shadow rays start a little off the surface, towards camera and lamp.
    const Vec3f to_lamp(towards[0][i], towards[1][i], towards[2][i]);
    const Vec3f point(lit.point[0][i], lit.point[1][i], lit.point[2][i]);
    shadow.set(i, point + 0.004f * (to_lamp - rays.directionOf(i)), to_lamp, distance[i] - 0.01f);
  }
  uint32_t shadowed = scene_.occluded(shadow);
  if (!light.bodies.empty()) shadowed |= occludedByBodies(light.bodies, shadow);
  for (int i = 0; i < kRayPacketSize; ++i) {
    if ((shadowed >> i & 1) == 0) radiance[i] += direct[i];
  }
}

void SurfaceShader::shade(const RayPacket& rays, const HitPacket& hits, const LightField& light,
                          float pixel_angle_rad, bool detail, float* radiance) const {
  Lit lit = {};
  for (int i = 0; i < kRayPacketSize; ++i) {
    if (std::isfinite(hits.range_m[i])) describe(rays, hits, i, pixel_angle_rad, detail, light, lit);
    radiance[i] = 0.0f;
  }
  if (!light.daylight.none()) {
    for (int i = 0; i < kRayPacketSize; ++i) {
      const Vec3f point(lit.point[0][i], lit.point[1][i], lit.point[2][i]);
      const Vec3f normal(lit.normal[0][i], lit.normal[1][i], lit.normal[2][i]);
      radiance[i] = lit.reflectance[i] * light.daylight.onSurface(point, normal);
    }
  }
  for (const PlacedLamp& lamp : light.lamps) {
    addLamp(rays, lit, lamp, light, radiance);
  }
  constexpr float kPerPi = 1.0f / std::numbers::pi_v<float>;
  for (int i = 0; i < kRayPacketSize; ++i) radiance[i] *= kPerPi;
}

}  // namespace lodeline
