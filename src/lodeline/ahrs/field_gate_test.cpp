#include "lodeline/ahrs/field_gate.h"

#include <gtest/gtest.h>

#include "lodeline/ahrs/heading_filter.h"

namespace lodeline {
namespace {

constexpr double kStep_s = 0.02;
const Vec3 kEarth_W(5e-6, 20e-6, -40e-6);

/// Feeds a field for a number of seconds and returns the last verdict.
FieldVerdict feed(FieldGate* gate, const Vec3& field_W, double seconds, double turn_rad_per_s = 0.0) {
  FieldVerdict verdict = FieldVerdict::None;
  for (double t = 0.0; t < seconds; t += kStep_s)
    verdict = gate->update(field_W, turn_rad_per_s * kStep_s, kStep_s);
  return verdict;
}

TEST(FieldShape, HasNormDipAndHorizontalPart) {
  const FieldShape shape = FieldShape::of(Vec3(3e-5, 0.0, -4e-5));
  EXPECT_DOUBLE_EQ(shape.norm_T, 5e-5);
  EXPECT_NEAR(shape.dip_rad, std::atan2(4.0, 3.0), 1e-12);
  EXPECT_NEAR(shape.horizontal_T(), 3e-5, 1e-15);
}

TEST(FieldGate, LearnsAReferenceAndJudgesByIt) {
  FieldGate gate({}, std::nullopt);
  EXPECT_EQ(feed(&gate, kEarth_W, 1.0), FieldVerdict::Settling);
  EXPECT_EQ(feed(&gate, kEarth_W, 4.0), FieldVerdict::Good);
  EXPECT_NEAR(gate.reference()->norm_T, kEarth_W.norm(), 1e-10);
  EXPECT_EQ(feed(&gate, 1.2 * kEarth_W, 2.0), FieldVerdict::WrongNorm);
  EXPECT_NEAR(gate.disturbance(), 0.2, 0.02);
  // Equal magnitude, smaller dip.
  const Vec3 flatter = Vec3(5e-6, 30e-6, -30e-6).normalized() * kEarth_W.norm();
  EXPECT_EQ(feed(&gate, flatter, 2.0), FieldVerdict::WrongDip);
  EXPECT_EQ(feed(&gate, kEarth_W, 0.2), FieldVerdict::Settling);
  EXPECT_EQ(feed(&gate, kEarth_W, 1.0), FieldVerdict::Good);
}

TEST(FieldGate, FollowsSlowChanges) {
  FieldGate gate({}, std::nullopt);
  feed(&gate, kEarth_W, 5.0);
  for (int i = 1; i <= 20; ++i)
    EXPECT_EQ(feed(&gate, (1.0 + 0.01 * i) * kEarth_W, 10.0), FieldVerdict::Good) << i;
}

TEST(FieldGate, TakesANewFieldOnlyWhenItHoldsThroughTurning) {
  FieldGate gate({}, std::nullopt);
  feed(&gate, kEarth_W, 5.0);
  EXPECT_EQ(feed(&gate, 1.3 * kEarth_W, 100.0), FieldVerdict::WrongNorm);
  EXPECT_EQ(feed(&gate, 1.3 * kEarth_W, 30.0, 0.5), FieldVerdict::Good);
}

TEST(FieldGate, KeepsTheSitesField) {
  FieldGate gate({}, FieldShape::of(kEarth_W));
  EXPECT_EQ(feed(&gate, 1.3 * kEarth_W, 100.0, 1.0), FieldVerdict::WrongNorm);
  EXPECT_DOUBLE_EQ(gate.reference()->norm_T, kEarth_W.norm());
}

TEST(HeadingFilter, StartsFromAnythingAndSettles) {
  HeadingFilter filter({});
  EXPECT_GT(filter.sigma_rad(), 1.5);
  EXPECT_TRUE(filter.accepts(3.0));
  for (int i = 0; i < 500; ++i) {
    filter.predict(1e-3, kStep_s);
    filter.correct(3.0, 0.0, false, kStep_s);
  }
  EXPECT_NEAR(filter.offset_rad(), 3.0, 0.01);
  EXPECT_LT(filter.sigma_rad(), 0.05);
  EXPECT_FALSE(filter.accepts(2.5));
  // Across the discontinuity of the angle.
  EXPECT_TRUE(filter.accepts(3.1 - 2.0 * std::numbers::pi));
}

TEST(HeadingFilter, GrowsUncertainWithTheBiasAndHeedsDisturbedFieldsLittle) {
  HeadingFilter filter({});
  filter.define(0.0);
  for (int i = 0; i < 3000; ++i) filter.predict(1e-3, kStep_s);
  // 60 s of a bias error of 1e-3 rad/s that changes every 10 s.
  EXPECT_NEAR(filter.sigma_rad(), 1e-3 * std::sqrt(60.0 * 10.0), 3e-3);
  const double before = filter.offset_rad();
  filter.correct(1.0, 1.0, true, kStep_s);
  EXPECT_LT(filter.offset_rad() - before, 1e-3);
}

}  // namespace
}  // namespace lodeline
