#include "simulation/rendering/cave/traced_scene.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lodeline {
namespace {

TriangleMesh sphere() {
  TriangleMesh mesh = unitIcosphere(5);
  for (Material& material : mesh.materials) material = Material::of(0.5f, 0.25f);
  mesh.computeNormals();
  return mesh;
}

TEST(TracedScene, SphereIsMetAtItsRadius) {
  const TracedScene scene(sphere());
  EXPECT_EQ(scene.triangleCount(), 20u << 10);
  for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0.3, -0.8, 0.2), Vec3(-1, 2, -3)}) {
    const auto from_inside = scene.range(Vec3::Zero(), direction.normalized());
    ASSERT_TRUE(from_inside);
    EXPECT_NEAR(*from_inside, 1.0, 1e-3);
    const auto from_outside = scene.range(-4.0 * direction.normalized(), direction.normalized());
    ASSERT_TRUE(from_outside);
    EXPECT_NEAR(*from_outside, 3.0, 1e-3);
  }
  EXPECT_FALSE(scene.range(Vec3(0, 0, 3), Vec3(1, 0, 0)));
}

TEST(TracedScene, PacketsAgreeWithSingleRays) {
  const TracedScene scene(sphere());
  RayPacket rays;
  for (int i = 0; i < kRayPacketSize; ++i) {
    rays.set(i, Vec3f(0, 0, -3), Vec3f(0.08f * (i - 8), 0.02f * i, 1).normalized(), 10.0f);
  }
  rays.disable(5);
  HitPacket hits;
  scene.intersect(rays, hits);
  int hit_count = 0;
  for (int i = 0; i < kRayPacketSize; ++i) {
    if (i == 5) {
      EXPECT_TRUE(std::isinf(hits.range_m[i]));
      continue;
    }
    const auto single = scene.range(Vec3(0, 0, -3), rays.directionOf(i).cast<double>());
    ASSERT_EQ(std::isfinite(hits.range_m[i]), single.has_value()) << i;
    if (!single) continue;
    ++hit_count;
    EXPECT_NEAR(hits.range_m[i], *single, 1e-5);
    const SurfacePoint surface = scene.surfaceAt(hits, i);
    const Vec3f point = rays.originOf(i) + hits.range_m[i] * rays.directionOf(i);
    EXPECT_GT(surface.normal.dot(point.normalized()), 0.9999f);
    EXPECT_NEAR(surface.reflectance, 0.5f, 0.003f);
    EXPECT_NEAR(surface.contrast, 0.25f, 0.003f);
  }
  EXPECT_GT(hit_count, 4);
}

TEST(TracedScene, ShadowRaysEndAtTheirRange) {
  const TracedScene scene(sphere());
  RayPacket rays;
  for (int i = 0; i < kRayPacketSize; ++i) rays.disable(i);
  rays.set(0, Vec3f(0, 0, -3), Vec3f::UnitZ(), 1.9f);
  rays.set(1, Vec3f(0, 0, -3), Vec3f::UnitZ(), 2.1f);
  rays.set(2, Vec3f(2, 0, -3), Vec3f::UnitZ(), 9.0f);
  EXPECT_EQ(scene.occluded(rays), 2u);
}

}  // namespace
}  // namespace lodeline
