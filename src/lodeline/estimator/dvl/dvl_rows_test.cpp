#include "lodeline/estimator/dvl/dvl_rows.h"

#include <gtest/gtest.h>

#include <limits>

#include "lodeline/estimator/dvl/dvl_innovation.h"
#include "lodeline/estimator/dvl/ping_integrator.h"
#include "lodeline/imu/test_motion.h"

namespace lodeline {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

DvlSample beamsOf(const std::vector<std::optional<double>>& velocities) {
  DvlSample sample;
  for (const auto& velocity : velocities)
    sample.beams.push_back({static_cast<int>(sample.beams.size()), velocity});
  return sample;
}

TEST(DvlRows, EachBeamWithLockIsARowAndTheVelocityIsNoneBesideThem) {
  const DvlCalibration dvl;
  DvlSample sample = beamsOf({0.1, std::nullopt, -0.2, 0.0});
  sample.velocity_D = Vec3(1.0, 2.0, 3.0);
  const DvlReading reading = readRows(sample, dvl);
  ASSERT_EQ(reading.rows.size(), 3u);
  EXPECT_FALSE(reading.is_velocity);
  EXPECT_EQ(reading.rows[1].direction_D, dvl.beams_D[2]);
  EXPECT_EQ(reading.rows[1].velocity_m_per_s, -0.2);
  EXPECT_TRUE(reading.fault.empty());
}

TEST(DvlRows, VelocityCountsWhereNoBeamHasOneAndIsNoBetterThanItSays) {
  DvlSample sample = beamsOf({std::nullopt, std::nullopt});
  sample.velocity_D = Vec3(0.1, 0.2, 0.0);
  sample.velocity_sigma_m_per_s = 0.04;
  const DvlReading reading = readRows(sample, DvlCalibration());
  ASSERT_EQ(reading.rows.size(), 3u);
  EXPECT_TRUE(reading.is_velocity);
  EXPECT_EQ(reading.sigma_m_per_s, 0.04);
  sample.velocity_sigma_m_per_s = kNoNumber;
  EXPECT_EQ(readRows(sample, DvlCalibration()).sigma_m_per_s, 0.01);
}

TEST(DvlRows, ImpossibleValuesAreLeftOutAndNamed) {
  const DvlCalibration dvl;
  EXPECT_EQ(readRows(beamsOf({0.1, kNoNumber, -32.768, 0.2}), dvl).rows.size(), 2u);
  EXPECT_FALSE(readRows(beamsOf({0.1, kNoNumber}), dvl).fault.empty());
  EXPECT_TRUE(readRows(beamsOf({0.0, 0.0, 0.0, 0.0}), dvl).rows.empty());
  EXPECT_FALSE(readRows(beamsOf({0.0, 0.0}), dvl).fault.empty());
  DvlSample sample;
  EXPECT_TRUE(readRows(sample, dvl).fault.empty()) << "no lock is no fault";
  for (const Vec3& velocity : {Vec3(0.0, 0.0, 0.0), Vec3(0.0, kNoNumber, 0.1), Vec3(8.0, 8.0, 0.0)}) {
    sample.velocity_D = velocity;
    EXPECT_TRUE(readRows(sample, dvl).rows.empty()) << velocity.transpose();
    EXPECT_FALSE(readRows(sample, dvl).fault.empty()) << velocity.transpose();
  }
  DvlSample unknown;
  unknown.beams = {{7, 0.1}, {-1, 0.2}, {1, 0.3}};
  EXPECT_EQ(readRows(unknown, dvl).rows.size(), 1u);
}

TEST(PingIntegrator, CarriesTheVelocityBackToThePing) {
  const TestMotion truth;
  PingIntegrator integrator(ImuCalibration(), {});
  integrator.add(truth.readings(0.0, 1.0, 200.0));
  const NavigationState frame = truth.state(Time::fromSeconds(1.0));
  for (const double ping_s : {1.0, 0.9475, 0.95, 0.4}) {
    const auto motion = integrator.motion(Time::fromSeconds(ping_s), frame);
    ASSERT_TRUE(motion) << ping_s;
    const Vec3 unfallen_W = frame.velocity_W - motion->elapsed_s * standardGravity_W();
    const Vec3 velocity_B = motion->rotation * (frame.world_from_body.rotation.conjugate() * unfallen_W) -
                            motion->velocity_change;
    EXPECT_LT((velocity_B - truth.rotation(ping_s).conjugate() * truth.velocity(ping_s)).norm(), 2e-3)
        << ping_s;
    EXPECT_LT((motion->rate_B - truth.rate_B(ping_s)).norm(), 1e-3) << ping_s;
  }
  EXPECT_FALSE(integrator.motion(Time::fromSeconds(-0.1), frame)) << "before the readings";
  EXPECT_FALSE(integrator.motion(Time::fromSeconds(0.9), truth.state(Time::fromSeconds(1.1))))
      << "no frame there";
}

TEST(ChiSquareQuantile, IsThatOfTheTables) {
  EXPECT_NEAR(chiSquareQuantile(1, 1.645), 3.84, 0.1);
  EXPECT_NEAR(chiSquareQuantile(3, 1.645), 7.81, 0.1);
  EXPECT_NEAR(chiSquareQuantile(3, 3.09), 16.27, 0.4);
}

}  // namespace
}  // namespace lodeline
