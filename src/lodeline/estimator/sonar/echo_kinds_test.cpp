#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "lodeline/estimator/sonar/sonar_fusion.h"
#include "lodeline/estimator/trials/scene.h"
#include "lodeline/geometry/so3.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

constexpr double kEchoRate_hz = 20.0;

/// One camera that moves so calmly in a room that its accelerometer tells little of the scale.
TestSceneOptions quietScene(uint64_t seed) {
  TestSceneOptions options;
  options.seed = seed;
  options.cameras = 1;
  options.duration_s = 24.0;
  options.liveliness = 0.08;
  options.drift_m_per_s = Vec3(0.15, 0.0, 0.0);
  options.wall_roughness_m = 0.05;
  options.points.frame_rate_hz = 10.0;
  options.points.tracks = 120;
  return options;
}

const Rigid3 kAltimeterHead(so3::exp(Vec3(0.05, -0.02, 0.1)), Vec3(0.05, 0.1, -0.2));

/// A DVL that looks ahead at the wall, where the camera sees it.
DvlCalibration dvlAhead() {
  DvlCalibration dvl;
  Mat3 axes_B;  // z forward
  axes_B << 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  dvl.body_from_dvl = Rigid3(Quat(axes_B), Vec3(0.1, 0.05, -0.1));
  dvl.beams_D = DvlCalibration::janusBeams_D(0.25);
  return dvl;
}

struct EchoDive {
  double scale_error = 0.0;  ///< of the velocities in the second half, relative
  int used = 0, echoes = 0;
  std::vector<SensorRow> rows;
};

using EchoReadings = std::function<SensorReadings(const TestScene&, double time_s, Time time, Random&)>;

template <typename Estimate>
EchoDive echoDive(uint64_t seed, const std::function<void(Rig*)>& mount, const EchoReadings& readings) {
  const TestSceneOptions options = quietScene(seed);
  TestScene scene(options);
  Rig rig = scene.rig();
  mount(&rig);
  EstimatorOptions estimator_options = honestOptions(options);
  estimator_options.dvl.use = false;
  ComparedEstimator estimator(scene, estimator_options, rig);
  Random random(seed, "echoes");
  EchoDive result;
  double along = 0.0, squares = 0.0;
  int64_t next = 0;
  while (const auto frame = scene.next()) {
    SensorReadings all;
    for (;; ++next) {
      const double time_s = (static_cast<double>(next) + 0.37) / kEchoRate_hz;
      const Time time = options.points.start + Duration::fromSeconds(time_s);
      if (time > frame->truth.time) break;
      SensorReadings one = readings(scene, time_s, time, random);
      one.prepend(std::move(all));
      all = std::move(one);
    }
    const Comparison c = estimator.add(*frame, all);
    const auto& estimate = c.estimate.sensors.of<Estimate>();
    result.used += estimate.used;
    result.echoes += estimate.echoes;
    result.rows = c.estimate.sensor_rows;
    if (!c.initialized() || c.time_s < 0.5 * options.duration_s) continue;
    along += c.estimate.state.velocity_W.dot(c.true_velocity_W);
    squares += c.true_velocity_W.squaredNorm();
  }
  result.scale_error = std::abs(along / squares - 1.0);
  return result;
}

double distanceAlong_m(const TestScene& scene, double time_s, const Rigid3& body_from_head,
                       const Vec3& along) {
  const Rigid3 world_from_head = scene.motion().at(time_s).world_from_body * body_from_head;
  return scene.distanceToWall_m(world_from_head.translation, world_from_head.rotation * along);
}

EchoDive altimeterDive(uint64_t seed, bool has_readings) {
  return echoDive<AltimeterEstimate>(
      seed,
      [](Rig* rig) {
        rig->altimeter = SonarCalibration{kEchoRate_hz, 0.05, kAltimeterHead};
      },
      [&](const TestScene& scene, double time_s, Time time, Random& random) {
        AltimeterSample sample{
            time, distanceAlong_m(scene, time_s, kAltimeterHead, Vec3::UnitX()) + 0.03 * random.normal()};
        return has_readings ? SensorReadings(std::vector{sample}) : SensorReadings();
      });
}

TEST(EchoKinds, AltimeterCarriesTheScaleOfOneCamera) {
  double with = 0.0, without = 0.0;
  for (const uint64_t seed : {1, 2}) {
    const EchoDive fused = altimeterDive(seed, true);
    with += std::pow(fused.scale_error, 2);
    without += std::pow(altimeterDive(seed, false).scale_error, 2);
    EXPECT_GT(fused.used, 100) << "seed " << seed;  // others have no landmarks around the beam
    ASSERT_EQ(fused.rows.size(), 1u);
    EXPECT_EQ(fused.rows.front().columns[1].first, "altimeter_echoes");
  }
  EXPECT_LT(std::sqrt(with), 0.8 * std::sqrt(without)) << std::sqrt(with) << " " << std::sqrt(without);
}

TEST(EchoKinds, BeamsOfADvlAreEchoesAlongTheirDirections) {
  const DvlCalibration dvl = dvlAhead();
  Rig rig;
  rig.dvl = dvl;
  DvlSample sample;
  sample.beams = {
      {2, 0.1, 3.0}, {0, std::nullopt, 4.0}, {1, 0.2, std::nullopt}, {7, 0.1, 5.0}, {-1, 0.1, 6.0}};
  std::vector<RawEcho> echoes;
  EchoSource<DvlSample>::of(rig)->append(sample, &echoes);
  ASSERT_EQ(echoes.size(), 2u);
  EXPECT_EQ(echoes[0].range_m, 3.0);
  EXPECT_EQ(echoes[1].range_m, 4.0);
  for (const auto& [echo, beam] : {std::pair(echoes[0], 2), std::pair(echoes[1], 0)}) {
    const Vec3 along_B = dvl.body_from_dvl.rotation * dvl.beams_D[static_cast<size_t>(beam)];
    EXPECT_LT((echo.beam.axes_B.col(0) - along_B).norm(), 1e-12);
    EXPECT_LT((echo.beam.axes_B.transpose() * echo.beam.axes_B - Mat3::Identity()).norm(), 1e-12);
    EXPECT_EQ(echo.beam.origin_B, dvl.body_from_dvl.translation);
  }
}

TEST(EchoKinds, RangesOfADvlAreUsed) {
  const DvlCalibration dvl = dvlAhead();
  const EchoDive fused = echoDive<DvlRangeEstimate>(
      2, [&](Rig* rig) { rig->dvl = dvl; },
      [&](const TestScene& scene, double time_s, Time time, Random& random) {
        DvlSample sample;
        sample.time = time;
        for (int i = 0; i < 3; ++i) {
          const double range_m =
              distanceAlong_m(scene, time_s, dvl.body_from_dvl, dvl.beams_D[static_cast<size_t>(i)]);
          sample.beams.push_back({i, std::nullopt, range_m + 0.03 * random.normal()});
        }
        return SensorReadings(std::vector{sample});
      });
  EXPECT_GT(fused.echoes, 3 * 300);
  EXPECT_GT(fused.used, fused.echoes / 2);
  EXPECT_LT(fused.scale_error, 0.01);
}

TEST(EchoKinds, SonarAndAltimeterHaveNamesOfTheirOwn) {
  const EchoDive both = echoDive<SonarEstimate>(
      3,
      [](Rig* rig) {
        rig->altimeter = rig->sonar = SonarCalibration{kEchoRate_hz, 0.05, kAltimeterHead};
      },
      [&](const TestScene& scene, double time_s, Time time, Random&) {
        const double range_m = distanceAlong_m(scene, time_s, kAltimeterHead, Vec3::UnitX());
        return SensorReadings(std::vector{SonarSample{time, range_m, 0.0}},
                              std::vector{AltimeterSample{time, range_m}});
      });
  ASSERT_EQ(both.rows.size(), 2u);
  EXPECT_EQ(both.rows[0].sensor, "sonar");
  EXPECT_EQ(both.rows[1].sensor, "altimeter");
  EXPECT_EQ(both.rows[0].columns[2].second, both.rows[1].columns[2].second) << "the same echoes";
}

}  // namespace
}  // namespace lodeline
