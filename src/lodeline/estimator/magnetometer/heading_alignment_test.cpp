#include "lodeline/estimator/magnetometer/heading_alignment.h"
#include "lodeline/util/angles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lodeline/estimator/initialization/start.h"
#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

// Devil's Eye, Florida (docs of the world magnetic model): declination -6.38, dip 57.97 degrees, 45.56 uT.
const Vec3 kSiteField_W =
    45.56e-6 * Vec3(std::cos(57.97 * kDegree) * std::sin(-6.38 * kDegree),
                    std::cos(57.97 * kDegree) * std::cos(-6.38 * kDegree), -std::sin(57.97 * kDegree));

Vec3 turned(const Vec3& field_W, double yaw_rad) { return so3::exp(yaw_rad * Vec3::UnitZ()) * field_W; }

MagnetometerOptions atTheSite() {
  MagnetometerOptions options;
  options.site_field_W = kSiteField_W;
  return options;
}

TEST(AlignHeading, TurnsTheWorldToMagneticNorth) {
  for (const double yaw_rad : {0.0, 1.0, -2.5, 3.1}) {
    const HeadingAlignment alignment = alignHeading(turned(kSiteField_W, yaw_rad), {});
    EXPECT_EQ(alignment.reference, HeadingReference::Magnetic);
    EXPECT_NEAR(alignment.field_W.x(), 0.0, 1e-15);
    EXPECT_GT(alignment.field_W.y(), 20e-6);
    EXPECT_LT((turned(turned(kSiteField_W, yaw_rad), alignment.yaw_rad) - alignment.field_W).norm(), 1e-15);
  }
}

TEST(AlignHeading, TurnsTheWorldToTrueNorthWhereTheSiteIsKnown) {
  for (const double yaw_rad : {0.0, 1.0, -2.5}) {
    const HeadingAlignment alignment = alignHeading(turned(kSiteField_W, yaw_rad), atTheSite());
    EXPECT_EQ(alignment.reference, HeadingReference::True);
    EXPECT_LT((alignment.field_W - kSiteField_W).norm(), 1e-15);
    EXPECT_NEAR(std::remainder(alignment.yaw_rad + yaw_rad, 2.0 * M_PI), 0.0, 1e-12);
  }
}

TEST(AlignHeading, TakesTheReferenceItIsTold) {
  MagnetometerOptions options = atTheSite();
  options.heading_reference = HeadingReference::Magnetic;
  EXPECT_NEAR(alignHeading(kSiteField_W, options).field_W.x(), 0.0, 1e-15);
  options.heading_reference = HeadingReference::Start;
  const HeadingAlignment start = alignHeading(kSiteField_W, options);
  EXPECT_EQ(start.reference, HeadingReference::Start);
  EXPECT_EQ(start.yaw_rad, 0.0);
  EXPECT_TRUE(start.refusal.empty());
}

TEST(AlignHeading, RefusesWithTheReason) {
  const auto refusal = [](const Vec3& field_W, const MagnetometerOptions& options) {
    const HeadingAlignment alignment = alignHeading(field_W, options);
    EXPECT_EQ(alignment.reference, HeadingReference::Start);
    EXPECT_EQ(alignment.yaw_rad, 0.0);
    return alignment.refusal;
  };
  EXPECT_NE(refusal(0.2 * kSiteField_W, {}).find("field of 9.1 uT"), std::string::npos);
  EXPECT_NE(refusal(3.0 * kSiteField_W, {}).find("22 to 67"), std::string::npos);
  EXPECT_NE(refusal(Vec3(0.0, 3e-6, -55e-6), {}).find("horizontal"), std::string::npos);
  EXPECT_NE(refusal(1.2 * kSiteField_W, atTheSite()).find("site has 45.6"), std::string::npos);
  const Vec3 tilted = so3::exp(10.0 * kDegree * Vec3::UnitX()) * kSiteField_W;
  EXPECT_NE(refusal(tilted, atTheSite()).find("dip"), std::string::npos);
  EXPECT_NE(refusal(Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), {}), "");
  MagnetometerOptions nowhere;
  nowhere.heading_reference = HeadingReference::True;
  EXPECT_NE(refusal(kSiteField_W, nowhere).find("place and date"), std::string::npos);
}

TEST(TurnWorld, TurnsStatesAndPriorAlike) {
  TestWindow test;
  TestSceneOptions scene_options;
  scene_options.duration_s = 1.5;
  scene_options.points.tracks = 20;
  scene_options.points.frame_rate_hz = 10.0;
  TestScene scene(scene_options);
  while (const auto frame = scene.next()) test.add(*frame);
  Frame& first = *test.window.frames().front();
  Prior prior = startPrior(first, test.options.initial_state, 0.05);
  const NavigationState before = test.window.newest().state();
  turnWorld(1.2, &test.window, &prior);

  const Quat turn = so3::exp(Vec3(0.0, 0.0, 1.2));
  const NavigationState after = test.window.newest().state();
  EXPECT_LT((after.world_from_body.translation - turn * before.world_from_body.translation).norm(), 1e-12);
  EXPECT_LT(after.world_from_body.rotation.angularDistance(turn * before.world_from_body.rotation), 1e-12);
  EXPECT_LT((after.velocity_W - turn * before.velocity_W).norm(), 1e-12);
  EXPECT_EQ(after.gyroscope_bias_B, before.gyroscope_bias_B);
  const double* values[] = {first.pose.data(), first.motion.data()};
  EXPECT_LT(prior.difference(values).norm(), 1e-12) << "the prior still lies at the first frame";
}

}  // namespace
}  // namespace lodeline
