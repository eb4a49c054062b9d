#include <gtest/gtest.h>

#include <cmath>

#include "simulation/dive/point_dive.h"
#include "simulation/sensors/pressure_model.h"
#include "simulation/sensors/sensor_clock.h"
#include "simulation/sensors/sonar_model.h"

namespace lodeline {
namespace {

class SmallSensorsTest : public testing::Test {
 protected:
  static DiveMotionOptions motionOptions() {
    DiveMotionOptions options;
    options.duration_s = 200.0;
    options.path_length_m = 45.0;
    return options;
  }
  PointDive dive_ = makePointDive(motionOptions(), standardRig({}), {});
  Rigid3 port_ = dive_.mounted.rig.pressure->body_from_pressure;

  double portDepth(double t) const {
    return 12.0 - (dive_.motion.at(t).world_from_body * port_.translation).z();
  }
};

TEST_F(SmallSensorsTest, PerfectDepthGaugeReadsTheDepthOfItsPort) {
  PressureModel model(dive_.motion, port_, 12.0, {}, 1);
  for (double t = 0.0; t < 200.0; t += 0.5) EXPECT_NEAR(model.measure(t), portDepth(t), 1e-12);
}

TEST_F(SmallSensorsTest, DepthGaugeErrorsActAsDescribed) {
  PressureErrors errors;
  errors.density_ratio = 1.025;
  errors.offset_m = 0.2;
  errors.resolution_m = 0.01;
  PressureModel scaled(dive_.motion, port_, 12.0, errors, 1);
  const double reading = scaled.measure(80.0);
  EXPECT_NEAR(reading, 1.025 * portDepth(80.0) + 0.2, 0.005 + 1e-9);
  EXPECT_NEAR(reading * 100.0, std::round(reading * 100.0), 1e-9);

  errors = {};
  errors.noise_m = 0.03;
  PressureModel noisy(dive_.motion, port_, 12.0, errors, 1);
  double squares = 0.0;
  for (int i = 0; i < 2000; ++i) squares += std::pow(noisy.measure(0.1 * i) - portDepth(0.1 * i), 2);
  EXPECT_NEAR(std::sqrt(squares / 2000), 0.03, 0.002);
}

TEST_F(SmallSensorsTest, DepthGaugeLagIsAFirstOrderDelay) {
  PressureErrors errors;
  errors.lag_s = 0.8;
  PressureModel model(dive_.motion, port_, 12.0, errors, 1);
  double difference_to_delayed = 0.0, difference_to_prompt = 0.0;
  for (double t = 0.0; t < 200.0; t += 0.5) {
    const double reading = model.measure(t);
    if (t < 20.0) continue;
    difference_to_delayed += std::pow(reading - portDepth(t - 0.8), 2);
    difference_to_prompt += std::pow(reading - portDepth(t), 2);
  }
  EXPECT_LT(difference_to_delayed, 0.5 * difference_to_prompt);
}

TEST_F(SmallSensorsTest, SonarMeasuresTheDistanceAlongItsBeam) {
  const Rigid3 mount = dive_.mounted.rig.sonar->body_from_sonar;
  // A flat floor 2 m below the start.
  const RangeFunction floor = [](const Vec3& origin, const Vec3& direction) -> std::optional<double> {
    if (direction.z() > -1e-6) return std::nullopt;
    return (-2.0 - origin.z()) / direction.z();
  };
  SonarErrors errors;
  errors.farthest_m = 20.0;
  SonarModel model(dive_.motion, mount, floor, errors, 1);
  int echoes = 0;
  for (double t = 0.0; t < 30.0; t += 0.05) {
    const auto sample = model.measure(t);
    if (!sample) continue;
    ++echoes;
    const Rigid3 world_from_sonar = dive_.motion.at(t).world_from_body * mount;
    const Vec3 hit = world_from_sonar *
                     (sample->range_m * Vec3(std::cos(sample->angle_rad), std::sin(sample->angle_rad), 0.0));
    EXPECT_NEAR(hit.z(), -2.0, 1e-9);
  }
  EXPECT_GT(echoes, 200);
  EXPECT_LT(echoes, 400);  // no echoes while looking up
}

TEST_F(SmallSensorsTest, SonarScansASectorToAndFro) {
  SonarErrors errors;
  errors.sector_rad = 0.5;
  const RangeFunction wall = [](const Vec3&, const Vec3&) -> std::optional<double> { return 4.0; };
  SonarModel model(dive_.motion, Rigid3(), wall, errors, 1);
  double least = 0.0, greatest = 0.0, last = model.measure(0.0)->angle_rad;
  for (double t = 0.01; t < 10.0; t += 0.01) {
    const double angle_rad = model.measure(t)->angle_rad;
    EXPECT_LE(std::abs(angle_rad - last), errors.turn_rad_per_s * 0.01 + 1e-9);
    least = std::min(least, angle_rad);
    greatest = std::max(greatest, angle_rad);
    last = angle_rad;
  }
  EXPECT_NEAR(least, -0.5, 0.01);
  EXPECT_NEAR(greatest, 0.5, 0.01);
}

TEST_F(SmallSensorsTest, SonarLosesAndFalsifiesEchoesByTheirShares) {
  SonarErrors errors;
  errors.dropout_share = 0.2;
  errors.spurious_share = 0.1;
  const RangeFunction wall = [](const Vec3&, const Vec3&) -> std::optional<double> { return 4.0; };
  SonarModel model(dive_.motion, Rigid3(), wall, errors, 1);
  int echoes = 0, wrong = 0;
  for (int i = 0; i < 10000; ++i) {
    const auto sample = model.measure(0.01 * i);
    if (!sample) continue;
    ++echoes;
    wrong += std::abs(sample->range_m - 4.0) > 1e-9;
  }
  EXPECT_NEAR(echoes, 8000, 200);
  EXPECT_NEAR(wrong, 800, 120);
}

TEST(SensorClock, DelaysDriftsJittersAndKeepsOrder) {
  const Time start = Time::fromSeconds(1000.0);
  SensorClock exact({}, start, 1, "cam0");
  EXPECT_EQ(exact.stamp(2.5), start + Duration::fromSeconds(2.5));

  SensorClock late({0.005, 20.0, 0.0, 0.0}, start, 1, "cam0");
  EXPECT_EQ(late.stamp(100.0), start + Duration::fromSeconds(100.007));

  SensorClock shaky({0.0, 0.0, 0.001, 0.02}, start, 1, "cam0");
  Time last = start - Duration::fromSeconds(1.0);
  double squares = 0.0;
  int dropped = 0;
  for (int i = 0; i < 10000; ++i) {
    const Time stamp = shaky.stamp(0.002 * i);
    EXPECT_GT(stamp, last);
    last = stamp;
    squares += std::pow((stamp - start).seconds() - 0.002 * i, 2);
    dropped += shaky.dropped();
  }
  EXPECT_NEAR(std::sqrt(squares / 10000), 0.001, 0.0001);
  EXPECT_NEAR(dropped, 200, 60);
}

}  // namespace
}  // namespace lodeline
