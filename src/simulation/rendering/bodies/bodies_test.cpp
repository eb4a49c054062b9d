// Geometry and motion of what swims: ellipsoids, fish, the buddy.
#include <gtest/gtest.h>

#include <cmath>

#include "simulation/rendering/bodies/buddy.h"
#include "simulation/rendering/bodies/fish.h"

namespace lodeline {
namespace {

BodyPart someEllipsoid() {
  BodyPart part;
  part.world_from_part =
      Rigid3(Quat(Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -1.0).normalized())), Vec3(2.0, 0.3, -0.2));
  part.half_axes_m = Vec3(0.5, 0.1, 0.2);
  return part;
}

Vec3 centreOf(const std::vector<PlacedEllipsoid>& bodies) {
  Vec3f sum = Vec3f::Zero();
  for (const PlacedEllipsoid& body : bodies) sum += body.centre() / static_cast<float>(bodies.size());
  return sum.cast<double>();
}

TEST(BodyPart, RaysEndOnItsSurface) {
  const BodyPart part = someEllipsoid();
  const PlacedEllipsoid placed(part);
  int hits = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec3f direction =
        Vec3f(2.0f, 0.3f + 0.05f * (i % 20 - 10), -0.2f + 0.05f * (i / 20 - 10)).normalized();
    const float range = placed.range(Vec3f::Zero(), direction, 60.0f);
    if (std::isinf(range)) continue;
    ++hits;
    const Vec3 point = part.world_from_part.inverse() * Vec3((range * direction).cast<double>());
    EXPECT_NEAR(point.cwiseQuotient(part.half_axes_m).norm(), 1.0, 1e-4);
    EXPECT_LT(placed.surfaceAt(range * direction).normal.dot(direction), 1e-3f);
    EXPECT_TRUE(std::isinf(placed.range(Vec3f::Zero(), direction, range - 0.01f)));
    EXPECT_TRUE(std::isinf(placed.range(Vec3f::Zero(), -direction, 60.0f)));
  }
  EXPECT_GT(hits, 20);
}

TEST(BodyPart, HidesAndShadesWhatIsBehind) {
  const std::vector<PlacedEllipsoid> bodies = {PlacedEllipsoid(someEllipsoid())};
  RayPacket rays;
  HitPacket hits;
  for (int i = 0; i < kRayPacketSize; ++i) {
    rays.set(i, Vec3f::Zero(), Vec3f(i % 2 == 0 ? 2.0f : -2.0f, 0.3f, -0.2f).normalized(), 60.0f);
    hits.range_m[i] = i < 4 ? 1.0f : 5.0f;
    hits.body[i] = -1;
  }
  intersectBodies(bodies, rays, hits);
  EXPECT_EQ(hits.body[0], -1);  // the scene is nearer
  EXPECT_EQ(hits.body[4], 0);
  EXPECT_LT(hits.range_m[4], 2.5f);
  EXPECT_EQ(hits.body[5], -1);  // it looks away
  EXPECT_EQ(occludedByBodies(bodies, rays), 0x5555u);
}

TEST(Fish, SwimAtTheirSpeedAndDriftWithTheCurrent) {
  FishSchool school;
  school.middle_s = 20.0;
  school.anchor_W = Vec3(1.0, 2.0, 3.0);
  school.velocity_W = Vec3(0.3, 0.0, 0.0);
  school.count = 4;
  school.seed = 5;
  DriftTrack current{1.0, {}};
  for (int i = 0; i <= 60; ++i) current.values.push_back(Vec3(0.0, 0.2 * i, 0.0));
  const auto meanAt = [&](double time_s, const DriftTrack* carrier) {
    std::vector<PlacedEllipsoid> bodies;
    placeFish({school}, carrier, time_s, bodies);
    EXPECT_EQ(bodies.size(), 20u);
    return centreOf(bodies);
  };
  const Vec3 alone = (meanAt(25.0, nullptr) - meanAt(15.0, nullptr)) / 10.0;
  EXPECT_LT((alone - school.velocity_W).norm(), 0.04);
  const Vec3 carried = (meanAt(25.0, &current) - meanAt(15.0, &current)) / 10.0;
  EXPECT_LT((carried - alone - Vec3(0.0, 0.2, 0.0)).norm(), 1e-5);
  std::vector<PlacedEllipsoid> gone;
  placeFish({school}, nullptr, school.middle_s + kSchoolLife_s + 0.1, gone);
  EXPECT_TRUE(gone.empty());
}

TEST(Buddy, KicksAndCarriesTheTorch) {
  Buddy buddy;
  buddy.world_from_buddy.step_s = 1.0;
  for (int i = 0; i <= 10; ++i)
    buddy.world_from_buddy.values.push_back(Rigid3(Quat::Identity(), Vec3(0.3 * i, 0.0, 0.0)));
  std::vector<PlacedEllipsoid> at_2, at_6;
  placeBuddy(buddy, 2.0, at_2);
  placeBuddy(buddy, 6.0, at_6);
  ASSERT_EQ(at_2.size(), at_6.size());
  EXPECT_NEAR((at_6[0].centre() - at_2[0].centre()).norm(), 1.2f, 1e-4f);
  double most = 0.0;
  for (size_t i = 0; i < at_2.size(); ++i)
    most = std::max<double>(most, (at_6[i].centre() - at_2[i].centre() - Vec3f(1.2f, 0.0f, 0.0f)).norm());
  EXPECT_GT(most, 0.05);
  EXPECT_LT(most, 0.8);
  const TorchPose a = torchOf(buddy, 2.0), b = torchOf(buddy, 6.0);
  EXPECT_LT((b.position_W - a.position_W - Vec3(1.2, 0.0, 0.0)).norm(), 1e-9);
  EXPECT_GT(std::acos(a.direction_W.dot(b.direction_W)), 0.05);
  // No part of the body covers the torch.
  for (const PlacedEllipsoid& body : at_2)
    EXPECT_TRUE(std::isinf(
        body.range((a.position_W + 2.0 * a.direction_W).cast<float>(), -a.direction_W.cast<float>(), 1.99f)));
}

}  // namespace
}  // namespace lodeline
