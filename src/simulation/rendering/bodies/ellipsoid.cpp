#include "simulation/rendering/bodies/ellipsoid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "simulation/rendering/cave/gradient_noise.h"

namespace lodeline {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();

}  // namespace

PlacedEllipsoid::PlacedEllipsoid(const BodyPart& part)
    : part_from_world_(part.world_from_part.rotation.conjugate().toRotationMatrix().cast<float>()),
      centre_W_(part.world_from_part.translation.cast<float>()),
      half_axes_m_(part.half_axes_m.cast<float>()),
      inverse_axes_(part.half_axes_m.cwiseInverse().cast<float>()),
      bounding_radius_m_(static_cast<float>(part.half_axes_m.maxCoeff())),
      back_(part.back_reflectance),
      belly_(part.belly_reflectance),
      contrast_(part.contrast),
      stripes_(part.stripes_per_length),
      gloss_(part.gloss),
      seed_(part.seed) {}

float PlacedEllipsoid::range(const Vec3f& origin_W, const Vec3f& direction_W, float most_m) const {
  const Vec3f to_centre = centre_W_ - origin_W;
  const float along = to_centre.dot(direction_W);
  if (along < -bounding_radius_m_ || along > most_m + bounding_radius_m_) return kNone;
  if (to_centre.squaredNorm() - along * along > bounding_radius_m_ * bounding_radius_m_) return kNone;
  // In axes in which the ellipsoid is the unit sphere.
  const Vec3f o = -(part_from_world_ * to_centre).cwiseProduct(inverse_axes_);
  const Vec3f d = (part_from_world_ * direction_W).cwiseProduct(inverse_axes_);
  const float a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - 1.0f;
  const float discriminant = b * b - a * c;
  if (c <= 0.0f || discriminant <= 0.0f) return kNone;
  const float range = (-b - std::sqrt(discriminant)) / a;
  return range > 0.0f && range < most_m ? range : kNone;
}

SurfacePoint PlacedEllipsoid::surfaceAt(const Vec3f& point_W) const {
  const Vec3f unit = (part_from_world_ * (point_W - centre_W_)).cwiseProduct(inverse_axes_);
  SurfacePoint surface;
  surface.normal = (part_from_world_.transpose() * unit.cwiseProduct(inverse_axes_)).normalized();
  float reflectance = lerp(belly_, back_, smoothStep(-0.5f, 0.4f, unit.z()));
  if (contrast_ > 0.0f) {
    const Vec3f cell = 14.0f / half_axes_m_.maxCoeff() * unit.cwiseProduct(half_axes_m_);
    float pattern = fractalNoise(cell, 2, seed_, 0.6f);
    if (stripes_ > 0.0f) {
      const float wavy = unit.x() + 0.12f * gradientNoise(2.5f * unit, seed_ + 1);
      pattern = 0.4f * pattern + 0.8f * std::sin(std::numbers::pi_v<float> * stripes_ * wavy);
    }
    reflectance *= std::clamp(1.0f + contrast_ * pattern, 0.15f, 2.0f);
  }
  surface.reflectance = reflectance;
  surface.gloss = gloss_;
  return surface;
}

void intersectBodies(const std::vector<PlacedEllipsoid>& bodies, const RayPacket& rays, HitPacket& hits) {
  for (size_t n = 0; n < bodies.size(); ++n) {
    for (int i = 0; i < kRayPacketSize; ++i) {
      if (rays.active[i] == 0) continue;
      const float range = bodies[n].range(rays.originOf(i), rays.directionOf(i),
                                          std::min(rays.max_range_m[i], hits.range_m[i]));
      if (range == kNone) continue;
      hits.range_m[i] = range;
      hits.body[i] = static_cast<int>(n);
    }
  }
}

uint32_t occludedByBodies(const std::vector<PlacedEllipsoid>& bodies, const RayPacket& rays) {
  uint32_t bits = 0;
  for (const PlacedEllipsoid& body : bodies) {
    for (int i = 0; i < kRayPacketSize; ++i) {
      if (rays.active[i] == 0 || (bits >> i & 1) != 0) continue;
      if (body.range(rays.originOf(i), rays.directionOf(i), rays.max_range_m[i]) != kNone) bits |= 1u << i;
    }
  }
  return bits;
}

}  // namespace lodeline
