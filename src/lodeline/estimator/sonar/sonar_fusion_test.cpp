#include "lodeline/estimator/sonar/sonar_fusion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "lodeline/diagnostics.h"
#include "lodeline/estimator/trials/scene.h"
#include "lodeline/geometry/so3.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

constexpr double kSonarRate_hz = 20.0;

/// A rig with one camera in a room, and a sonar that scans the view to and fro. It moves so calmly that its
/// accelerometer tells little of the scale.
TestSceneOptions calmScene(uint64_t seed) {
  TestSceneOptions options;
  options.seed = seed;
  options.cameras = 1;
  options.duration_s = 30.0;
  options.liveliness = 0.08;
  options.drift_m_per_s = Vec3(0.15, 0.0, 0.0);
  options.wall_roughness_m = 0.05;
  options.points.frame_rate_hz = 10.0;
  options.points.tracks = 120;
  return options;
}

Rig rigWithSonar(const TestScene& scene) {
  Rig rig = scene.rig();
  rig.sonar =
      SonarCalibration{kSonarRate_hz, 0.05, Rigid3(so3::exp(Vec3(0.05, -0.02, 0.1)), Vec3(0.05, 0.1, -0.2))};
  return rig;
}

using Spoil = std::function<void(Random& random, SonarSample*)>;

/// The echoes up to each frame, from the true pose at their own times.
class Sonar {
 public:
  Sonar(const TestScene& scene, const SonarCalibration& sonar, const TestSceneOptions& options)
      : scene_(scene), sonar_(sonar), start_(options.points.start), random_(options.seed, "sonar") {}

  std::vector<SonarSample> until(Time end, const Spoil& spoil) {
    std::vector<SonarSample> samples;
    for (;; ++next_) {
      const double t_s = (static_cast<double>(next_) + 0.37) / kSonarRate_hz;
      SonarSample sample;
      sample.time = start_ + Duration::fromSeconds(t_s);
      if (sample.time > end) return samples;
      sample.angle_rad = 0.5 * std::sin(0.8 * t_s);
      const Rigid3 world_from_sonar = scene_.motion().at(t_s).world_from_body * sonar_.body_from_sonar;
      const Vec3 beam_S(std::cos(sample.angle_rad), std::sin(sample.angle_rad), 0.0);
      const double range_m =
          scene_.distanceToWall_m(world_from_sonar.translation, world_from_sonar.rotation * beam_S);
      sample.range_m = range_m + 0.03 * random_.normal();
      if (spoil) spoil(random_, &sample);
      samples.push_back(sample);
    }
  }

 private:
  const TestScene& scene_;
  SonarCalibration sonar_;
  Time start_;
  Random random_;
  int64_t next_ = 0;
};

struct SonarDive {
  double scale_error = 0.0;  ///< of the velocities in the second half, relative
  int used = 0, echoes = 0;
  std::vector<Finding> findings;
  FrameEstimate last;
};

SonarDive dive(uint64_t seed, bool has_sonar, const Spoil& spoil = {},
               const std::function<void(Rig*)>& change = {}) {
  const TestSceneOptions options = calmScene(seed);
  TestScene scene(options);
  const Rig true_rig = rigWithSonar(scene);
  Rig rig = true_rig;
  if (change) change(&rig);
  EstimatorOptions estimator_options = honestOptions(options);
  estimator_options.sonar.use = has_sonar;
  ComparedEstimator estimator(scene, estimator_options, rig);
  Sonar sonar(scene, *true_rig.sonar, options);
  SonarDive result;
  double along = 0.0, squares = 0.0;
  while (const auto frame = scene.next()) {
    const Comparison c = estimator.add(*frame, SensorReadings(sonar.until(frame->truth.time, spoil)));
    const auto& estimate = c.estimate.sensors.of<SonarEstimate>();
    result.used += estimate.used;
    result.echoes += estimate.echoes;
    result.last = c.estimate;
    if (!c.initialized() || c.time_s < 0.5 * options.duration_s) continue;
    along += c.estimate.state.velocity_W.dot(c.true_velocity_W);
    squares += c.true_velocity_W.squaredNorm();
  }
  result.scale_error = std::abs(along / squares - 1.0);
  result.findings = estimator.diagnostics().ranked();
  return result;
}

int countOf(const char* kind, const SonarDive& dive) {
  int count = 0;
  for (const Finding& finding : dive.findings) count += finding.kind == kind;
  return count;
}

TEST(SonarFusion, CarriesTheScaleOfOneCamera) {
  double with = 0.0, without = 0.0;
  for (const uint64_t seed : {1, 2, 3, 4, 5}) {
    const SonarDive fused = dive(seed, true), alone = dive(seed, false);
    with += std::pow(fused.scale_error, 2) / 5.0;
    without += std::pow(alone.scale_error, 2) / 5.0;
    RecordProperty("with_" + std::to_string(seed), std::to_string(fused.scale_error));
    RecordProperty("without_" + std::to_string(seed), std::to_string(alone.scale_error));
    EXPECT_GT(fused.used, fused.echoes / 2) << "seed " << seed;
    EXPECT_EQ(alone.used, 0);
  }
  EXPECT_LT(std::sqrt(with), 0.6 * std::sqrt(without)) << std::sqrt(with) << " " << std::sqrt(without);
}

TEST(SonarFusion, FalseEchoesHardlyMatter) {
  const auto spoil = [](Random& random, SonarSample* sample) {
    if (random.chance(0.15)) sample->range_m *= random.uniform(0.1, 0.8);
  };
  const SonarDive clean = dive(4, true), spoiled = dive(4, true, spoil);
  EXPECT_LT(spoiled.used, clean.used);
  EXPECT_LT(spoiled.scale_error, 0.005 + clean.scale_error);
}

TEST(SonarFusion, ReadingsThatAreNoEchoesAreLeftOutAndReported) {
  const auto spoil = [](Random&, SonarSample* sample) {
    const int64_t turn = (sample->time.nanoseconds() / 50'000'000) % 4;
    constexpr double kNone[] = {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), 50.0};
    sample->range_m = kNone[turn];
  };
  const SonarDive nothing = dive(5, true, spoil, [](Rig* rig) { rig->sonar->max_range_m = 10.0; });
  EXPECT_EQ(nothing.used, 0);
  EXPECT_EQ(nothing.echoes, 0);
  EXPECT_EQ(countOf("sonar_invalid", nothing), 1);
  const SonarDive without = dive(5, false);
  EXPECT_EQ(nothing.last.state.world_from_body.translation, without.last.state.world_from_body.translation);
  EXPECT_EQ(nothing.last.covariance, without.last.covariance);
}

TEST(SonarFusion, BeamWithoutLandmarksIsNotUsed) {
  const SonarDive behind = dive(6, true, {}, [](Rig* rig) {
    rig->sonar->body_from_sonar =
        Rigid3(Quat(Eigen::AngleAxisd(M_PI, Vec3::UnitZ())), rig->sonar->body_from_sonar.translation);
  });
  EXPECT_EQ(behind.used, 0);
  EXPECT_GT(behind.echoes, 400) << "of 600, one camera starts late";
  EXPECT_EQ(countOf("sonar_rejected", behind), 0);
}

TEST(SonarFusion, RangesInAnotherUnitAreRejectedAndReported) {
  const auto inFeet = [](Random&, SonarSample* sample) { sample->range_m /= 0.3048; };
  const SonarDive wrong = dive(7, true, inFeet);
  EXPECT_EQ(countOf("sonar_rejected", wrong), 1);
  EXPECT_LT(wrong.used, wrong.echoes / 4);
}

TEST(SonarOptions, RefusesValuesOutOfTheirRanges) {
  EXPECT_NO_THROW(SonarOptions().check());
  const auto refuses = [](double SonarOptions::*member, double value) {
    SonarOptions options;
    options.*member = value;
    EXPECT_THROW(options.check(), UsageError) << value;
  };
  refuses(&SonarOptions::surface_angle_rad, 0.0);
  refuses(&SonarOptions::surface_angle_rad, 1.5);
  refuses(&SonarOptions::noise_inflation, -1.0);
  refuses(&SonarOptions::max_sigmas, std::numeric_limits<double>::quiet_NaN());
  refuses(&SonarOptions::greatest_scale_sigma, 0.01);
  SonarOptions options;
  options.min_landmarks = 3;
  EXPECT_THROW(options.check(), UsageError);
}

}  // namespace
}  // namespace lodeline
