#include "lodeline/output/report/noise_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "simulation/sensors/imu_model.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

/// Three hours of a simulated IMU at rest, at 50 Hz instead of 200, which does not change the densities.
class ThreeHours {
 public:
  ThreeHours(std::string_view grade, uint64_t seed) {
    constexpr double kRate_hz = 50.0;
    truth = drawImuErrors(imuGrade(grade), {}, seed);
    ImuModel imu(truth, kRate_hz, seed);
    SensorNoiseAnalysis rate(gyroscopeToAnalyse(), &diagnostics),
        force(accelerometerToAnalyse(), &diagnostics);
    for (int i = 0; i < 540000; ++i) {
      ImuSample sample;
      sample.time = Time::fromNanoseconds(int64_t{20000000} * i);
      sample.specific_force_B = Vec3(0.3, -0.2, 9.8);
      sample = imu.measure(sample);
      rate.add(sample.time, sample.angular_velocity_B);
      force.add(sample.time, sample.specific_force_B);
    }
    gyroscope = rate.finish();
    accelerometer = force.finish();
  }

  Diagnostics diagnostics;
  ImuErrors truth;
  SensorNoise gyroscope, accelerometer;
};

void expectFound(const NoiseFit& fit, const TriadErrors& truth) {
  EXPECT_NEAR(fit.white.value, truth.noise_density, 0.05 * truth.noise_density);
  EXPECT_NEAR(fit.instability.value, truth.bias_instability, 0.2 * truth.bias_instability);
  EXPECT_NEAR(fit.walk.value, truth.random_walk, 0.2 * truth.random_walk);
  EXPECT_TRUE(fit.white.resolved && fit.instability.resolved && fit.walk.resolved);
}

TEST(NoiseReport, FindsTheDensitiesOfASimulatedImu) {
  const ThreeHours record("gx5-25", 1);
  expectFound(record.gyroscope.all, record.truth.gyroscope);
  expectFound(record.accelerometer.all, record.truth.accelerometer);
}

TEST(NoiseReport, TellsPeopleProgramsAndKalibrTheSame) {
  const ThreeHours record("consumer", 2);
  const std::vector<SensorNoise> sensors = {record.gyroscope, record.accelerometer};
  const std::string table = noiseTable(sensors);
  EXPECT_THAT(table, HasSubstr("deg/h"));
  EXPECT_THAT(table, HasSubstr("two-sided"));
  EXPECT_THAT(table, HasSubstr("one-sided"));

  const nlohmann::ordered_json json = noiseJson(sensors);
  const auto& gyroscope = json["sensors"]["gyroscope"];
  EXPECT_DOUBLE_EQ(gyroscope["all"]["white_noise"]["value"].get<double>(), record.gyroscope.all.white.value);
  EXPECT_EQ(gyroscope["allan_deviation"]["rows"].size(), record.gyroscope.curve.points.size());

  const YAML::Node yaml = YAML::Load(kalibrImuYaml(record.gyroscope, record.accelerometer));
  const auto density = [&](const char* key) { return yaml[key].as<double>(); };
  EXPECT_NEAR(density("gyroscope_noise_density"), record.gyroscope.all.white.value, 1e-9);
  EXPECT_NEAR(density("accelerometer_noise_density"), record.accelerometer.all.white.value, 1e-7);
  EXPECT_GT(density("gyroscope_random_walk"), 0.0);
  EXPECT_GT(density("accelerometer_random_walk"), 0.0);
  EXPECT_NEAR(density("update_rate"), 50.0, 1e-3);
}

TEST(NoiseReport, GivesKalibrTheInstabilityWhereNoWalkWasSeen) {
  SensorNoise noise;
  noise.sensor = gyroscopeToAnalyse();
  noise.all.white = {1e-4, 1e-6, 1e-4, true};
  noise.all.instability = {1e-5, 1e-6, 1.2e-5, true};
  const YAML::Node yaml = YAML::Load(kalibrImuYaml(noise, noise));
  EXPECT_NEAR(yaml["gyroscope_random_walk"].as<double>(), noise.all.walkWithInstability(100.0), 1e-11);
}

TEST(NoiseReport, StatesTheMagnetometersKeys) {
  SensorNoise noise;
  noise.sensor = magnetometerToAnalyse();
  noise.rate_hz = 50.0;
  noise.all.white = {1e-8, 1e-10, 1e-8, true};
  const YAML::Node yaml = YAML::Load(magnetometerYaml(noise));
  EXPECT_DOUBLE_EQ(yaml["magnetometer_noise_density"].as<double>(), 1e-8);
  EXPECT_DOUBLE_EQ(yaml["rate_hz"].as<double>(), 50.0);
}

}  // namespace
}  // namespace lodeline
