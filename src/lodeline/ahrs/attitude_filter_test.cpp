#include "lodeline/ahrs/attitude_filter.h"
#include "lodeline/util/angles.h"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <random>

#include "lodeline/imu/test_motion.h"

namespace lodeline {
namespace {

constexpr double kRate_hz = 200.0;
constexpr int kEvery = 4;  ///< IMU readings per magnetometer reading
const Vec3 kNorthField_W(0.0, 24e-6, -38e-6);

/// Heading and inclination error of an attitude, rad. The rotation is split into one about the vertical and
/// one about a horizontal axis.
double headingError(const Quat& estimate, const Quat& truth) {
  const Quat error = estimate * truth.conjugate();
  return std::remainder(2.0 * std::atan2(error.z(), error.w()), 2.0 * std::numbers::pi);
}
double inclinationError(const Quat& estimate, const Quat& truth) {
  const Quat error = estimate * truth.conjugate();
  return 2.0 * std::acos(std::min(1.0, std::hypot(error.w(), error.z())));
}

/// Five seconds at rest, then TestMotion slowed down, measured by sensors with noise and a gyroscope bias.
class AttitudeFilterTest : public ::testing::Test {
 protected:
  static constexpr double kRest_s = 5.0;

  double motionTime(double t) const { return always_still || t < kRest_s ? 0.0 : slowness * (t - kRest_s); }
  Quat truth(double t) const { return turned * motion.rotation(motionTime(t)); }

  ImuSample imu(double t) {
    const bool still = always_still || t < kRest_s;
    const double s = motionTime(t);
    const Vec3 rate_B = still ? Vec3(Vec3::Zero()) : Vec3(slowness * motion.rate_B(s));
    const Vec3 acceleration_W =
        still ? Vec3(Vec3::Zero()) : Vec3(slowness * slowness * motion.acceleration(s));
    ImuSample sample;
    sample.time = Time::fromSeconds(100.0 + t);
    sample.angular_velocity_B = rate_B + bias_B + 0.0014 * noise3();
    sample.specific_force_B =
        motion.rotation(s).conjugate() * (acceleration_W - standardGravity_W()) + 0.02 * noise3();
    return sample;
  }

  MagnetometerSample field(double t, const Vec3& field_W) {
    return {Time::fromSeconds(100.0 + t), truth(t).conjugate() * field_W + 0.1e-6 * noise3()};
  }

  Vec3 noise3() {
    const double x = normal_(engine_), y = normal_(engine_), z = normal_(engine_);
    return {x, y, z};
  }

  /// Runs to `end_s`. `each(t)` is called after every IMU reading; `field_at(t)` returns the field (nothing:
  /// no reading).
  template <typename Field, typename Each>
  void run(AttitudeFilter* filter, double end_s, Field field_at, Each each) {
    for (int i = 0; i <= end_s * kRate_hz; ++i) {
      const double t = i / kRate_hz;
      if (skip && skip(t)) continue;
      filter->add(imu(t));
      const std::optional<Vec3> field_W = i % kEvery == 0 ? field_at(t) : std::nullopt;
      if (field_W) filter->add(field(t, *field_W));
      each(t);
    }
  }
  static std::optional<Vec3> earthField(double) { return kNorthField_W; }
  static std::optional<Vec3> noField(double) { return std::nullopt; }

  AttitudeFilter filterWithMagnetometer(const AttitudeFilterOptions& options = {}) {
    MagnetometerCalibration magnetometer;
    magnetometer.rate_hz = kRate_hz / kEvery;
    return AttitudeFilter(options, magnetometer, &diagnostics);
  }

  Diagnostics diagnostics;
  TestMotion motion;
  Quat turned = Quat(Eigen::AngleAxisd(2.0, Vec3::UnitZ()));  ///< arbitrary heading
  double slowness = 0.4;
  bool always_still = false;
  Vec3 bias_B = Vec3(0.02, -0.015, 0.01);
  std::function<bool(double)> skip;

 private:
  std::mt19937_64 engine_{7};
  std::normal_distribution<double> normal_;
};

TEST_F(AttitudeFilterTest, FindsAttitudeBiasAndHeadingAtRest) {
  always_still = true;
  AttitudeFilter filter = filterWithMagnetometer();
  run(&filter, 20.0, earthField, [](double) {});
  const AttitudeEstimate& estimate = *filter.estimate();
  EXPECT_LT(std::abs(headingError(estimate.world_from_body, truth(20.0))), 0.5 * kDegree);
  EXPECT_LT(inclinationError(estimate.world_from_body, truth(20.0)), 0.2 * kDegree);
  EXPECT_LT((estimate.gyroscope_bias_B - bias_B).norm(), 0.05 * kDegree);
  EXPECT_TRUE(estimate.at_rest);
  EXPECT_EQ(estimate.status, HeadingStatus::Magnetic);
  EXPECT_LT(estimate.heading_sigma_rad, 3.0 * kDegree);
}

TEST_F(AttitudeFilterTest, FollowsAMovingBody) {
  AttitudeFilter filter = filterWithMagnetometer();
  double heading = 0.0, inclination = 0.0, normalized = 0.0;
  int count = 0;
  run(&filter, 90.0, earthField, [&](double t) {
    if (t < 3.0) return;
    const AttitudeEstimate& e = *filter.estimate();
    const double error = headingError(e.world_from_body, truth(t));
    heading += error * error;
    inclination += std::pow(inclinationError(e.world_from_body, truth(t)), 2);
    normalized += std::pow(error / e.heading_sigma_rad, 2);
    ++count;
  });
  EXPECT_LT(std::sqrt(heading / count), 1.0 * kDegree);
  // Swaying with 0.4 to 0.5 m/s^2 at 0.7 to 1.2 rad/s. The filter leaves 0.2 m/s^2 of it, which is one
  // degree.
  EXPECT_LT(std::sqrt(inclination / count), 1.5 * kDegree);
  EXPECT_LT(normalized / count, 1.5);
  EXPECT_LT((filter.estimate()->gyroscope_bias_B - bias_B).norm(), 0.2 * kDegree);
}

TEST_F(AttitudeFilterTest, LearnsABiasInMotionAlone) {
  skip = [](double t) { return t < kRest_s; };
  bias_B = Vec3(0.02, -0.02, 0.0);
  AttitudeFilter filter = filterWithMagnetometer();
  run(&filter, 120.0, earthField, [](double) {});
  // The vertical part stays unknown, and the body rotates. The error falls below a third of its initial
  // value.
  EXPECT_LT((filter.estimate()->gyroscope_bias_B - bias_B).norm(), 0.33 * bias_B.norm());
  EXPECT_LT(inclinationError(filter.estimate()->world_from_body, truth(120.0)), 3.0 * kDegree);
}

TEST_F(AttitudeFilterTest, HoldsHeadingThroughADisturbance) {
  AttitudeFilter filter = filterWithMagnetometer();
  double largest = 0.0, tilt = 0.0;
  int rejected = 0;
  run(
      &filter, 60.0,
      [](double t) {
        const bool disturbed = t > 25.0 && t < 45.0;
        return std::optional<Vec3>(kNorthField_W +
                                   (disturbed ? Vec3(15e-6, -5e-6, 8e-6) : Vec3(Vec3::Zero())));
      },
      [&](double t) {
        if (t < 20.0) return;
        const AttitudeEstimate& e = *filter.estimate();
        largest = std::max(largest, std::abs(headingError(e.world_from_body, truth(t))));
        tilt = std::max(tilt, inclinationError(e.world_from_body, truth(t)));
        rejected += t > 26.0 && t < 45.0 && e.status != HeadingStatus::Magnetic ? 1 : 0;
      });
  EXPECT_LT(largest, 3.0 * kDegree);  // the heading of the field was wrong by 38 degrees
  EXPECT_LT(tilt, 3.0 * kDegree);
  EXPECT_GT(rejected, 0.98 * 19.0 * kRate_hz);
  EXPECT_EQ(filter.estimate()->status, HeadingStatus::Magnetic);
}

TEST_F(AttitudeFilterTest, TakesALastingChangeOfTheFieldInTheEnd) {
  AttitudeFilter filter = filterWithMagnetometer();
  int readmitted = 0;
  run(
      &filter, 160.0,
      [](double t) { return std::optional<Vec3>(t < 20.0 ? kNorthField_W : Vec3(0.0, 30e-6, -25e-6)); },
      [&](double t) {
        if (t > 25.0 && t < 35.0) {
          EXPECT_NE(filter.estimate()->status, HeadingStatus::Magnetic);
        }
        readmitted += filter.estimate()->status == HeadingStatus::Readmitted ? 1 : 0;
      });
  EXPECT_NEAR(filter.referenceField()->norm_T, std::hypot(30e-6, 25e-6), 1e-6);
  EXPECT_EQ(filter.estimate()->status, HeadingStatus::Magnetic);
  EXPECT_LT(std::abs(headingError(filter.estimate()->world_from_body, truth(160.0))), 3.0 * kDegree);
}

TEST_F(AttitudeFilterTest, JudgesTheFieldByTheSiteWhereThatIsKnown) {
  AttitudeFilterOptions options;
  options.site_field_W = Vec3(-3e-6, 24e-6, -38e-6);
  AttitudeFilter filter = filterWithMagnetometer(options);
  // Disturbed from the first reading. Without the site, the disturbed field would have become the reference.
  run(
      &filter, 30.0, [](double) { return std::optional<Vec3>(Vec3(20e-6, 10e-6, -60e-6)); }, [](double) {});
  EXPECT_EQ(filter.estimate()->status, HeadingStatus::WrongNorm);
  EXPECT_GT(filter.estimate()->heading_sigma_rad, 60.0 * kDegree);

  AttitudeFilter true_north = filterWithMagnetometer(options);
  run(
      &true_north, 30.0, [&](double) { return options.site_field_W; }, [](double) {});
  EXPECT_LT(std::abs(headingError(true_north.estimate()->world_from_body, truth(30.0))), 2.0 * kDegree);
}

TEST_F(AttitudeFilterTest, GoesOnWithoutAMagnetometer) {
  AttitudeFilter filter(AttitudeFilterOptions{}, std::nullopt, &diagnostics);
  double first = 0.0;
  run(&filter, 40.0, earthField, [&](double t) {
    if (t == 0.0) first = headingError(filter.estimate()->world_from_body, truth(t));
  });
  const AttitudeEstimate& e = *filter.estimate();
  EXPECT_EQ(e.status, HeadingStatus::NoMagnetometer);
  const double drift =
      std::remainder(headingError(e.world_from_body, truth(40.0)) - first, 2 * std::numbers::pi);
  EXPECT_LT(std::abs(drift), 4.0 * kDegree);
  EXPECT_LT(std::abs(drift), 3.0 * e.heading_sigma_rad);

  AttitudeFilter silent = filterWithMagnetometer();
  run(&silent, 5.0, noField, [](double) {});
  EXPECT_EQ(silent.estimate()->status, HeadingStatus::Waiting);
  EXPECT_GT(silent.estimate()->heading_sigma_rad, 90.0 * kDegree);
}

TEST_F(AttitudeFilterTest, SaysWhenTheMagnetometerFreezes) {
  AttitudeFilter filter = filterWithMagnetometer();
  double sigma_before = 0.0;
  std::optional<Vec3> frozen_M;
  for (int i = 0; i <= 40 * 200; ++i) {
    const double t = i / kRate_hz;
    filter.add(imu(t));
    MagnetometerSample sample = field(t, kNorthField_W);
    if (t > 20.0 && !frozen_M) frozen_M = sample.field_M;
    if (frozen_M) sample.field_M = *frozen_M;
    if (i % kEvery == 0) filter.add(sample);
    if (t < 20.0) sigma_before = filter.estimate()->heading_sigma_rad;
  }
  EXPECT_EQ(filter.estimate()->status, HeadingStatus::Waiting);
  EXPECT_GT(filter.estimate()->heading_sigma_rad, sigma_before);
  EXPECT_LT(std::abs(headingError(filter.estimate()->world_from_body, truth(40.0))), 3.0 * kDegree);
}

TEST_F(AttitudeFilterTest, IsNotMisledByTheUnitOfAWildFirstReading) {
  for (const Vec3& wild : {Vec3(4e4, 0.0, 0.0), Vec3(0.3, 0.2, 0.1)}) {
    Diagnostics heard;
    AttitudeFilter filter(AttitudeFilterOptions{}, MagnetometerCalibration(), &heard);
    for (int i = 0; i <= 40 * 200; ++i) {
      const double t = i / kRate_hz;
      filter.add(imu(t));
      MagnetometerSample sample = field(t, kNorthField_W);
      sample.field_M *= 1e6;
      if (i == 0) sample.field_M = wild;
      if (i % kEvery == 0) filter.add(sample);
    }
    EXPECT_EQ(filter.estimate()->status, HeadingStatus::Magnetic) << wild.transpose();
    EXPECT_LT(std::abs(headingError(filter.estimate()->world_from_body, truth(40.0))), 2.0 * kDegree);
    EXPECT_EQ(heard.count("magnetometer_converted"), 1);
  }
}

TEST_F(AttitudeFilterTest, TakesReadingsAtAnyRate) {
  for (const int every : {200, 1}) {  // 1 and 200 Hz; the IMU has 200 Hz here
    MagnetometerCalibration magnetometer;
    magnetometer.rate_hz = kRate_hz / every;
    AttitudeFilter filter(AttitudeFilterOptions{}, magnetometer, &diagnostics);
    for (int i = 0; i <= 60 * 200; ++i) {
      filter.add(imu(i / kRate_hz));
      if (i % every == 0) filter.add(field(i / kRate_hz, kNorthField_W));
    }
    EXPECT_EQ(filter.estimate()->status, HeadingStatus::Magnetic) << every;
    EXPECT_LT(std::abs(headingError(filter.estimate()->world_from_body, truth(60.0))), 3.0 * kDegree);
  }
}

TEST_F(AttitudeFilterTest, TakesLaggingReadingsAtTheirOwnTime) {
  // Stamps corrected to the time of the field: readings arrive late, for moments before the last one.
  AttitudeFilter filter = filterWithMagnetometer();
  slowness = 1.0;
  double heading = 0.0;
  int count = 0;
  for (int i = 0; i <= 60 * 200; ++i) {
    const double t = i / kRate_hz;
    filter.add(imu(t));
    if (i % kEvery == 0 && t > 0.2) filter.add(field(t - 0.1, kNorthField_W));
    if (t < 3.0) continue;
    heading += std::pow(headingError(filter.estimate()->world_from_body, truth(t)), 2);
    ++count;
  }
  EXPECT_LT(std::sqrt(heading / count), 1.5 * kDegree);
}

TEST_F(AttitudeFilterTest, PassesOverBadAndRepeatedReadings) {
  always_still = true;
  AttitudeFilter filter = filterWithMagnetometer();
  filter.add(MagnetometerSample{Time::fromSeconds(99.0), kNorthField_W});  // before any IMU reading
  run(&filter, 10.0, earthField, [](double) {});
  const Quat before = filter.estimate()->world_from_body;
  const Time last = filter.estimate()->time;
  ImuSample bad = imu(10.1);
  bad.specific_force_B.x() = std::nan("");
  filter.add(bad);
  ImuSample late = imu(9.0);
  filter.add(late);
  MagnetometerSample nothing = field(9.99, kNorthField_W);
  nothing.field_M.setZero();
  filter.add(nothing);
  nothing.field_M.setConstant(std::nan(""));
  filter.add(nothing);
  EXPECT_EQ(filter.estimate()->time, last);
  EXPECT_EQ(filter.estimate()->world_from_body.coeffs(), before.coeffs());
  EXPECT_EQ(diagnostics.count("imu_not_finite"), 1);
  EXPECT_EQ(diagnostics.count("imu_disorder"), 1);
  EXPECT_EQ(diagnostics.count("magnetometer_invalid"), 2);
}

TEST_F(AttitudeFilterTest, StartsAnewAfterALongGap) {
  AttitudeFilter filter = filterWithMagnetometer();
  skip = [](double t) { return t > 20.0 && t < 30.0; };
  double after_s = 0.0;
  run(&filter, 50.0, earthField, [&](double t) {
    if (t >= 30.0 && after_s == 0.0) after_s = t;
  });
  EXPECT_EQ(diagnostics.count("attitude_restart"), 1);
  EXPECT_LT(std::abs(headingError(filter.estimate()->world_from_body, truth(50.0))), 2.0 * kDegree);
  EXPECT_LT(inclinationError(filter.estimate()->world_from_body, truth(50.0)), 2.0 * kDegree);
}

TEST_F(AttitudeFilterTest, IsTheSameEveryTime) {
  const auto last = [this] {
    motion = TestMotion();
    AttitudeFilter filter = filterWithMagnetometer();
    TestMotion same;
    for (int i = 0; i < 2000; ++i) {
      filter.add(same.reading(Time::fromSeconds(i / kRate_hz)));
      filter.add(MagnetometerSample{Time::fromSeconds(i / kRate_hz),
                                    same.rotation(i / kRate_hz).conjugate() * kNorthField_W});
    }
    return filter.estimate()->world_from_body;
  };
  EXPECT_EQ(last().coeffs(), last().coeffs());
}

}  // namespace
}  // namespace lodeline
