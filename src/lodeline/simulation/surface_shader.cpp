#include "lodeline/simulation/surface_shader.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lodeline {
namespace {

// Rock seen near, at arm's length and across the room; incommensurate, so that no repetition lines up.
constexpr float kTile_m[3] = {0.43f, 2.1f, 11.3f};
constexpr float kTileContrast[3] = {0.62f, 0.55f, 0.40f};
constexpr float kTileRelief[3] = {0.75f, 0.55f, 0.0f};

// Light that has met more than one wall, as a share of the direct light that reaches a place: it comes from
// all around and knows no shadows. For walls of albedo 0.35 that fill half the view, 0.35 * 0.5 * 0.35 =
// 0.06.
constexpr float kIndirectShare = 0.06f;

/// Each tile size is turned differently, so that their lattices do not align.
Vec3f turned(const Vec3f& p, int tile) {
  switch (tile) {
    case 0:
      return p;
    case 1:
      return {0.80f * p.x() + 0.60f * p.y(), -0.48f * p.x() + 0.64f * p.y() + 0.60f * p.z(),
              0.36f * p.x() - 0.48f * p.y() + 0.80f * p.z()};
    default:
      return {0.60f * p.y() + 0.80f * p.z(), p.x(), 0.80f * p.y() - 0.60f * p.z()};
  }
}

Vec3f turnedBack(const Vec3f& p, int tile) {
  switch (tile) {
    case 0:
      return p;
    case 1:
      return {0.80f * p.x() - 0.48f * p.y() + 0.36f * p.z(), 0.60f * p.x() + 0.64f * p.y() - 0.48f * p.z(),
              0.60f * p.y() + 0.80f * p.z()};
    default:
      return {p.y(), 0.60f * p.x() + 0.80f * p.z(), 0.80f * p.x() - 0.60f * p.z()};
  }
}

}  // namespace

SurfaceShader::Lit SurfaceShader::surface(const RayPacket& rays, const HitPacket& hits, int i,
                                          float pixel_angle_rad, bool detail) const {
  const SurfacePoint base = scene_.surfaceAt(hits, i);
  const Vec3f view = rays.directionOf(i);
  Lit lit;
  lit.point = rays.originOf(i) + hits.range_m[i] * view;
  lit.normal = base.normal;
  lit.reflectance = base.reflectance;
  lit.gloss = base.gloss;
  const float facing = -base.normal.dot(view);
  if (facing < 0.0f) lit.normal = -lit.normal;
  if (!detail) return lit;

  // At grazing incidence a pixel covers a long strip; the geometric mean of its axes is a fair width.
  const float footprint = hits.range_m[i] * pixel_angle_rad / std::sqrt(std::max(0.08f, std::abs(facing)));
  float shade = 0.0f;
  Vec3f slope = Vec3f::Zero();
  for (int tile = 0; tile < 3; ++tile) {
    const TextureSample sample = texture_.sample(turned(lit.point, tile), kTile_m[tile], footprint);
    shade += kTileContrast[tile] * sample.reflectance;
    if (kTileRelief[tile] > 0.0f) slope += kTileRelief[tile] * turnedBack(sample.slope, tile);
  }
  lit.reflectance *= std::clamp(1.0f + base.contrast * shade, 0.12f, 2.4f);
  // A relief h over the surface tilts its normal by minus the tangential part of h's gradient (J. Blinn,
  // "Simulation of wrinkled surfaces", SIGGRAPH 1978).
  slope *= base.contrast;
  lit.normal = (lit.normal - (slope - slope.dot(lit.normal) * lit.normal)).normalized();
  return lit;
}

void SurfaceShader::shade(const RayPacket& rays, const HitPacket& hits, const LightField& light,
                          float pixel_angle_rad, bool detail, float* radiance) const {
  Lit lit[kRayPacketSize];
  for (int i = 0; i < kRayPacketSize; ++i) {
    radiance[i] = 0.0f;
    if (!std::isfinite(hits.range_m[i])) continue;
    lit[i] = surface(rays, hits, i, pixel_angle_rad, detail);
    radiance[i] = lit[i].reflectance * light.daylight.onSurface(lit[i].point, lit[i].normal);
  }
  const float attenuation = light.water.meanAttenuation();
  for (const PlacedLamp& lamp : light.lamps) {
    RayPacket shadow;
    float direct[kRayPacketSize];
    for (int i = 0; i < kRayPacketSize; ++i) {
      shadow.disable(i);
      if (!std::isfinite(hits.range_m[i])) continue;
      const Vec3f to_lamp = lamp.position() - lit[i].point;
      const float distance = std::max(0.05f, to_lamp.norm());
      const Vec3f towards = to_lamp / distance;
      const float arriving = lamp.irradiance(towards, distance) * fastExp(-attenuation * distance);
      radiance[i] += kIndirectShare * lit[i].reflectance * arriving;
      const float cosine = lit[i].normal.dot(towards);
      if (cosine <= 0.0f) continue;
      direct[i] = lit[i].reflectance * arriving * cosine;
      if (lit[i].gloss > 0.0f) {
        // Blinn-Phong's broad highlight (SIGGRAPH 1977), exponent 32.
        const Vec3f half = (towards - rays.directionOf(i)).normalized();
        const float aligned = std::max(0.0f, lit[i].normal.dot(half));
        const float a2 = aligned * aligned, a4 = a2 * a2, a8 = a4 * a4, a16 = a8 * a8;
        direct[i] += 0.35f * lit[i].gloss * arriving * a16 * a16;
      }
      // Shadow rays start a little off the surface, back towards camera and lamp.
      const Vec3f start = lit[i].point - 0.004f * rays.directionOf(i) + 0.004f * towards;
      shadow.set(i, start, towards, distance - 0.01f);
    }
    const uint32_t shadowed = scene_.occluded(shadow);
    for (int i = 0; i < kRayPacketSize; ++i) {
      if (shadow.active[i] != 0 && (shadowed >> i & 1) == 0) radiance[i] += direct[i];
    }
  }
  constexpr float kPerPi = 1.0f / std::numbers::pi_v<float>;
  for (int i = 0; i < kRayPacketSize; ++i) radiance[i] *= kPerPi;
}

}  // namespace lodeline
