#include "simulation/sensors/magnetometer_model.h"
#include "lodeline/util/angles.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"
#include "simulation/dive/point_dive.h"

namespace lodeline {
namespace {

class MagnetometerModelTest : public testing::Test {
 protected:
  static DiveMotionOptions motionOptions() {
    DiveMotionOptions options;
    options.duration_s = 400.0;
    options.path_length_m = 90.0;
    return options;
  }

  Vec3 worldField(const MagnetometerErrors& errors, const Vec3& reading_M, double time_s) const {
    return dive_.motion.at(time_s).world_from_body.rotation *
           (errors.body_from_magnetometer.rotation * corrected(reading_M, errors));
  }

  PointDive dive_ = makePointDive(motionOptions(), standardRig({}), {});
  Vec3 field_W_ = worldMagneticField({29.83, -82.60, 0.0}, 2026.8877).field_ENU;
};

TEST_F(MagnetometerModelTest, CorrectedReadingsInTheWorldAreConstantToANanotesla) {
  MagnetometerSpecimenOptions specimen;
  specimen.noise = false;
  const MagnetometerErrors errors = drawMagnetometerErrors("gx5-25", specimen, 5);
  EXPECT_GT(errors.hard_iron_T.norm(), 5e-6);
  EXPECT_GT((errors.soft_iron - Mat3::Identity()).norm(), 0.02);
  MagnetometerModel model(dive_.motion, field_W_, {}, errors, 50.0, 1);
  double worst_T = 0.0, raw_spread_T = 0.0;
  for (double t = 0.0; t < 400.0; t += 0.02) {
    const Vec3 reading = model.measure(t);
    worst_T = std::max(worst_T, (worldField(errors, reading, t) - field_W_).cwiseAbs().maxCoeff());
    raw_spread_T = std::max(raw_spread_T, std::abs(reading.norm() - field_W_.norm()));
  }
  RecordProperty("worst_nT", std::to_string(1e9 * worst_T));
  EXPECT_LT(worst_T, 1e-9);
  EXPECT_GT(raw_spread_T, 2e-6);
}

TEST_F(MagnetometerModelTest, WhiteNoiseHasItsDensity) {
  MagnetometerErrors errors;
  errors.noise_density_T_per_sqrtHz = 1e-8;
  MagnetometerModel model(dive_.motion, field_W_, {}, errors, 50.0, 1);
  double squares = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const double t = 0.02 * i;
    squares += (worldField(errors, model.measure(t), t) - field_W_).squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(squares / 30000), 1e-8 * std::sqrt(50.0), 1e-8 * std::sqrt(50.0) * 0.02);
}

TEST_F(MagnetometerModelTest, LagsRepeatsSaturatesAndCreeps) {
  MagnetometerErrors errors;
  errors.lag_s = 0.015;
  MagnetometerModel lagging(dive_.motion, field_W_, {}, errors, 50.0, 1);
  MagnetometerModel prompt(dive_.motion, field_W_, {}, {}, 50.0, 1);
  EXPECT_LT((lagging.measure(100.015) - prompt.measure(100.0)).norm(), 1e-15);

  errors = {};
  errors.repeat_share = 0.29;
  MagnetometerModel repeating(dive_.motion, field_W_, {}, errors, 50.0, 1);
  int repeats = 0;
  Vec3 last = repeating.measure(20.0);
  for (int i = 1; i <= 10000; ++i) {
    const Vec3 reading = repeating.measure(20.0 + 0.02 * i);
    repeats += reading == last;
    last = reading;
  }
  EXPECT_NEAR(repeats / 10000.0, 0.29, 0.02);

  errors = {};
  errors.range_T = 20e-6;
  MagnetometerModel saturating(dive_.motion, field_W_, {}, errors, 50.0, 1);
  EXPECT_LE(saturating.measure(50.0).cwiseAbs().maxCoeff(), 20e-6);

  errors = {};
  errors.hard_iron_creep_T_per_s = Vec3(1e-9, 0.0, 0.0);
  MagnetometerModel creeping(dive_.motion, field_W_, {}, errors, 50.0, 1);
  EXPECT_LT((creeping.measure(300.0) - prompt.measure(300.0) - Vec3(0.3e-6, 0, 0)).norm(), 1e-15);
}

TEST_F(MagnetometerModelTest, HardIronWalksWithTheRootOfTime) {
  MagnetometerErrors errors;
  errors.hard_iron_walk_T_per_sqrt_s = 2e-9;
  constexpr int kWalks = 300;
  double squares = 0.0;
  for (uint64_t seed = 1; seed <= kWalks; ++seed) {
    MagnetometerModel walking(dive_.motion, field_W_, {}, errors, 1.0, seed);
    for (const double t : {0.0, 40.0, 100.0}) {
      const Vec3 walked = worldField(errors, walking.measure(t), t) - field_W_;
      if (t == 100.0) squares += walked.squaredNorm();
    }
  }
  EXPECT_NEAR(std::sqrt(squares / (3 * kWalks)), 2e-9 * 10.0, 2e-9);
}

TEST(WanderingField, HasItsSizeAndItsMemory) {
  constexpr double kSigma_T = 5e-8, kCorrelation_s = 5.0, kDuration_s = 40000.0;
  const WanderingField field = drawWanderingField(kDuration_s, kSigma_T, kCorrelation_s, 1);
  double squares = 0.0, products = 0.0;
  int count = 0;
  for (double t = 0.0; t < kDuration_s - kCorrelation_s; t += 1.0, count += 3) {
    squares += field.at(t).squaredNorm();
    products += field.at(t).dot(field.at(t + kCorrelation_s));
  }
  EXPECT_NEAR(std::sqrt(squares / count), kSigma_T, 0.05 * kSigma_T);
  EXPECT_NEAR(products / squares, std::exp(-1.0), 0.05);
  EXPECT_EQ(field.at(-1.0), field.at(0.0));
  EXPECT_EQ(field.at(2.0 * kDuration_s), field.field_W.back());
  EXPECT_TRUE(WanderingField().at(3.0).isZero());
}

TEST(Dipole, FollowsTheInverseCubeAndItsAxes) {
  const Vec3 moment(0.0, 0.0, 10.0);
  EXPECT_LT((dipoleField(moment, Vec3(0, 0, 1)) - Vec3(0, 0, 2e-6)).norm(), 1e-18);
  EXPECT_LT((dipoleField(moment, Vec3(1, 0, 0)) - Vec3(0, 0, -1e-6)).norm(), 1e-18);
  EXPECT_LT((dipoleField(moment, Vec3(0, 0, 2)) - Vec3(0, 0, 0.25e-6)).norm(), 1e-18);
}

TEST_F(MagnetometerModelTest, DrawnDisturbancesTurnTheHeadingByTwoToTenDegrees) {
  DisturbanceOptions options;
  options.mean_interval_s = 60.0;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    options.seed = seed;
    const MagneticDisturbances all = drawDisturbances(dive_.motion, field_W_, options);
    ASSERT_GE(all.passing.size() + all.lying.size(), 3u);
    ASSERT_GE(all.lying.size(), 1u);
    const auto worst = [&](const MagneticDisturbances& one) {
      double deflection = 0.0;
      for (double t = 0.0; t < 400.0; t += 0.5) {
        const Vec3 field = one.at(dive_.motion.at(t).world_from_body, t);
        deflection = std::max(deflection, std::abs(headingDeflection(field_W_, field)));
      }
      return deflection / kDegree;
    };
    for (const LyingDipole& dipole : all.lying) {
      EXPECT_GT(worst({{dipole}, {}, {}}), 1.9);
      EXPECT_LT(worst({{dipole}, {}, {}}), 10.5);
    }
    for (const PassingIron& iron : all.passing) {
      EXPECT_GT(worst({{}, {iron}, {}}), 1.9);
      EXPECT_LT(worst({{}, {iron}, {}}), 10.5);
      const double whole_s = iron.duration_s + 2.0 * iron.ramp_s;
      EXPECT_GE(whole_s, 9.99);
      EXPECT_LE(whole_s, 30.01);
    }
    EXPECT_LT(all.at(dive_.motion.at(5.0).world_from_body, 5.0).norm(), 0.05 * field_W_.norm());
  }
}

TEST(LampSwitching, IsOnForAPartOfTheTime) {
  const auto switched = drawLampSwitching(1200.0, 3);
  ASSERT_GE(switched.size(), 2u);
  for (const SwitchedCurrent& s : switched) {
    EXPECT_GE(s.field_B.norm(), 0.09e-6);
    EXPECT_LE(s.field_B.norm(), 0.41e-6);
  }
}

}  // namespace
}  // namespace lodeline
