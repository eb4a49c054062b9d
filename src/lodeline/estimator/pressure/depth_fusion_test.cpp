#include "lodeline/estimator/pressure/depth_fusion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include "lodeline/estimator/trials/scene.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

constexpr double kNever = 1e9;

/// A gauge with two readings per second, each 30 ms before a frame.
struct Gauge {
  double noise_m = 0.015;
  double density_ratio = 1.0;
  double lag_s = 0.0;
  /// Modifies a reading by a fault.
  std::function<double(double time_s, double depth_m)> fault = [](double, double depth_m) { return depth_m; };
};

struct Dive {
  std::vector<Comparison> frames;
  std::map<DepthStatus, int> statuses;
  std::map<std::string, int64_t> findings;

  double largestHeightError(double from_s, double to_s) const {
    double largest_m = 0.0;
    for (const Comparison& c : frames) {
      if (c.initialized() && c.time_s >= from_s && c.time_s < to_s)
        largest_m = std::max(largest_m, std::abs(c.error[2]));
    }
    return largest_m;
  }
  const FrameEstimate& last() const { return frames.back().estimate; }
};

TestSceneOptions sceneOptions(double duration_s) {
  TestSceneOptions options;
  options.duration_s = duration_s;
  options.points.tracks = 40;
  options.points.frame_rate_hz = 10.0;
  return options;
}

/// `no_images`: time span without frames, in which inertial readings and those of the gauge continue.
Dive dive(const TestSceneOptions& options, const std::optional<Gauge>& gauge, EstimatorOptions estimator,
          const MotionInterval& no_images = {}) {
  constexpr double kEarly_s = 0.03;
  const double period_s = 1.0 / options.points.frame_rate_hz;
  const int readings_apart = static_cast<int>(std::lround(0.5 / period_s));
  TestScene scene(options);
  ComparedEstimator compared(scene, estimator);
  const Vec3 port_B = scene.rig().pressure->body_from_pressure.translation;
  Random random(options.seed, "gauge");
  Dive result;
  std::optional<double> shown_m;
  double height_before_m = 0.0;
  int count = 0;
  std::vector<DepthSample> readings;
  std::vector<ImuSample> imu;
  while (auto frame = scene.next()) {
    const MotionState& truth = frame->truth.motion;
    const double height_m = (truth.world_from_body * port_B).z() - kEarly_s * truth.velocity_W.z();
    if (gauge) {
      const double keep = gauge->lag_s > 0.0 ? std::exp(-period_s / gauge->lag_s) : 0.0;
      shown_m = shown_m ? keep * *shown_m + (1.0 - keep) * 0.5 * (height_m + height_before_m) : height_m;
      if (keep == 0.0) shown_m = height_m;
      height_before_m = height_m;
      if (count++ % readings_apart == 0) {
        const double depth_m = 12.0 - gauge->density_ratio * *shown_m + gauge->noise_m * random.normal();
        readings.push_back({frame->truth.time - Duration::fromSeconds(kEarly_s),
                            gauge->fault(scene.secondsOf(frame->truth.time), depth_m)});
      }
    }
    imu.insert(imu.end(), frame->imu.begin() + (imu.empty() ? 0 : 1), frame->imu.end());
    if (no_images.contains(scene.secondsOf(frame->truth.time))) continue;
    frame->imu = std::exchange(imu, {});
    result.frames.push_back(compared.add(*frame, std::exchange(readings, {})));
    ++result.statuses[result.last().sensors.of<DepthEstimate>().status];
  }
  for (const Finding& finding : compared.diagnostics().ranked())
    result.findings[finding.kind] = finding.count;
  return result;
}

Dive dive(const TestSceneOptions& options, const std::optional<Gauge>& gauge) {
  return dive(options, gauge, honestOptions(options));
}

TEST(DepthFusion, HoldsTheHeightInTheDark) {
  TestSceneOptions options = sceneOptions(24.0);
  options.points.blackouts = {{12.0, 8.0}};
  const Dive with = dive(options, Gauge());
  const Dive without = dive(options, std::nullopt);
  EXPECT_LT(with.largestHeightError(2.0, kNever), 0.06);
  EXPECT_GT(without.largestHeightError(12.0, 20.0), 0.06) << "too easy a scene";
  for (const Comparison& c : with.frames) {
    if (c.time_s < 2.0) continue;
    EXPECT_LT(std::abs(c.error[2]), 4.0 * std::sqrt(c.estimate.covariance(2, 2))) << "at " << c.time_s;
  }
  EXPECT_EQ(with.statuses.count(DepthStatus::Jump), 0u);
  EXPECT_TRUE(with.findings.empty());
}

// Forty readings then belong to one frame, and the speeds at both ends do not describe the motion between
// them.
TEST(DepthFusion, CarriesOnWhereImagesAreMissing) {
  const TestSceneOptions options = sceneOptions(40.0);
  const Dive gap = dive(options, Gauge(), honestOptions(options), {10.0, 20.0});
  EXPECT_LT(gap.largestHeightError(31.0, kNever), 0.06);
  EXPECT_EQ(gap.statuses.count(DepthStatus::Jump), 0u);
  EXPECT_EQ(gap.statuses.count(DepthStatus::Slope), 0u);
  EXPECT_TRUE(gap.findings.empty());
}

TEST(DepthFusion, FindsLagAndDensity) {
  TestSceneOptions options = sceneOptions(40.0);
  options.drift_m_per_s = Vec3(0.0, 0.0, -0.1);
  Gauge gauge;
  gauge.density_ratio = 0.975;
  gauge.lag_s = 0.7;
  // The density is observable only with a more accurate scale: cameras with a correct calibration.
  EstimatorOptions estimator = honestOptions(options);
  estimator.camera_calibration.enabled = false;
  const Dive found = dive(options, gauge, estimator);
  const DepthEstimate::Gauge& last = found.last().sensors.of<DepthEstimate>().gauge.value();
  EXPECT_NEAR(last.lag_s, 0.7, 0.1);
  EXPECT_LT(last.lag_sigma_s, 0.05);
  EXPECT_LT(last.density_ratio_sigma, 0.008);
  EXPECT_NEAR(last.density_ratio, 0.975, 3.0 * last.density_ratio_sigma);
  EXPECT_LT(last.density_ratio, 0.992);
  // The depth is that of the water: the gauge reads 12 m at the origin, which is 12 m / 0.975 deep.
  const double height_m = found.last().state.world_from_body.translation.z();
  EXPECT_NEAR(last.body_depth_m, 12.0 / 0.975 - height_m, 3.0 * 12.0 * last.density_ratio_sigma);
  EXPECT_GT(std::abs(last.body_depth_m - (12.0 - 0.975 * height_m)), 0.25);
  EXPECT_EQ(found.statuses.count(DepthStatus::Jump), 0u);
  EXPECT_EQ(found.statuses.count(DepthStatus::Slope), 0u) << "a lag is no other unit";
}

TEST(DepthFusion, ClaimsHeightsNoBetterThanADensityThatCrookedCamerasFound) {
  TestSceneOptions options = sceneOptions(8.0);
  options.drift_m_per_s = Vec3(0.0, 0.0, -0.2);
  EstimatorOptions estimator = honestOptions(options);
  estimator.camera_calibration.enabled = true;
  estimator.depth.water_density_prior = false;
  const auto lastWith = [&](double least_density_sigma) {
    estimator.depth.least_density_sigma = least_density_sigma;
    return dive(options, Gauge(), estimator).last();
  };
  const FrameEstimate believed = lastWith(0.0);
  const FrameEstimate doubted = lastWith(0.007);
  const double height_m = doubted.state.world_from_body.translation.z();
  ASSERT_LT(height_m, -0.5);
  EXPECT_EQ(believed.state.world_from_body.translation, doubted.state.world_from_body.translation);
  EXPECT_NEAR(doubted.covariance(2, 2) - believed.covariance(2, 2), 0.007 * 0.007 * height_m * height_m,
              1e-12);
  EXPECT_GT(doubted.sensors.of<DepthEstimate>().gauge->density_ratio_sigma,
            believed.sensors.of<DepthEstimate>().gauge->density_ratio_sigma);
  estimator.depth.density_ratio_sigma = 0.001;
  const double told = lastWith(0.007).covariance(2, 2) - lastWith(0.0).covariance(2, 2);
  EXPECT_NEAR(told, 1e-6 * height_m * height_m, 1e-8) << "a density that was told";
}

/// Last estimate of a descent of 8 m.
FrameEstimate endOfDescent(double density_ratio, const std::function<void(EstimatorOptions*)>& change) {
  TestSceneOptions options = sceneOptions(40.0);
  options.points.frame_rate_hz = 5.0;
  options.drift_m_per_s = Vec3(0.0, 0.0, -0.2);
  EstimatorOptions estimator = honestOptions(options);
  change(&estimator);
  Gauge gauge;
  gauge.density_ratio = density_ratio;
  return dive(options, gauge, estimator).last();
}

TEST(DepthFusion, KnowsFreshWaterAndSalt) {
  for (const double ratio : {0.975, 1.0, 1.025}) {
    const auto descend = [ratio](bool water_density_prior) {
      return endOfDescent(ratio, [water_density_prior](EstimatorOptions* options) {
        options->camera_calibration.enabled = false;
        options->depth.water_density_prior = water_density_prior;
      });
    };
    const FrameEstimate with = descend(true), without = descend(false);
    const DepthEstimate::Gauge& known = *with.sensors.of<DepthEstimate>().gauge;
    const DepthEstimate::Gauge& seen = *without.sensors.of<DepthEstimate>().gauge;
    EXPECT_LT(std::abs(known.density_ratio - ratio), 0.8 * std::abs(seen.density_ratio - ratio)) << ratio;
    EXPECT_NEAR(known.density_ratio, ratio, 3.0 * known.density_ratio_sigma) << ratio;
    EXPECT_LT(known.density_ratio_sigma, seen.density_ratio_sigma) << ratio;
    EXPECT_LT(with.covariance(2, 2), without.covariance(2, 2)) << "known of the water is known of the height";
    EXPECT_GT(with.scale.depth, without.scale.depth) << "and of the scale";
  }
}

// Images give the ratio with a sigma below half a per cent here, but 0.7 % is the lower limit. This holds for
// a calibration that images have not confirmed, so the correct one of this scene must not be.
TEST(DepthFusion, WeighsWaterDensityPriorAgainstWhatCrookedCamerasAreWorth) {
  const auto descend = [](bool water_density_prior) {
    return *endOfDescent(1.0,
                         [water_density_prior](EstimatorOptions* options) {
                           options->camera_calibration.enabled = true;
                           options->camera_calibration.trust_confirmed_files = false;
                           options->depth.water_density_prior = water_density_prior;
                         })
                .sensors.of<DepthEstimate>()
                .gauge;
  };
  const DepthEstimate::Gauge known = descend(true), seen = descend(false);
  EXPECT_GT(std::abs(seen.density_ratio - 1.0), 0.007) << "too easy a scene";
  EXPECT_LT(std::abs(known.density_ratio - 1.0), 0.7 * std::abs(seen.density_ratio - 1.0));
}

TEST(DepthFusion, BelievesWhoWasToldTheDensity) {
  const auto told = [](bool water_density_prior) {
    return endOfDescent(0.99, [water_density_prior](EstimatorOptions* options) {
      options->depth.density_ratio = 0.99;
      options->depth.density_ratio_sigma = 0.002;
      options->depth.water_density_prior = water_density_prior;
    });
  };
  EXPECT_EQ(told(true).state.world_from_body.translation, told(false).state.world_from_body.translation);
  EXPECT_EQ(told(true).covariance, told(false).covariance);
}

TEST(DepthFusion, CarriesTheScaleOfOneCameraThatSinks) {
  TestSceneOptions options = sceneOptions(30.0);
  options.cameras = 1;
  options.points.tracks = 90;
  options.liveliness = 0.4;
  options.drift_m_per_s = Vec3(0.1, 0.0, -0.2);
  const auto scaleSigma = [](const Dive& d) {
    const Eigen::Matrix<double, 15, 15>& covariance = d.last().covariance;
    return std::sqrt(covariance(2, 2)) / std::abs(d.last().state.world_from_body.translation.z());
  };
  const Dive with = dive(options, Gauge());
  const Dive without = dive(options, std::nullopt);
  ASSERT_TRUE(with.frames.back().initialized() && without.frames.back().initialized());
  EXPECT_LT(scaleSigma(with), 0.5 * scaleSigma(without));
  EXPECT_LT(with.largestHeightError(10.0, kNever), 0.1);
}

// With any fault of a gauge, odometry must not be much worse than without the gauge.
class FaultyGauge : public testing::Test {
 protected:
  FaultyGauge() : options_(sceneOptions(32.0)) {
    options_.points.frame_rate_hz = 4.0;
    options_.drift_m_per_s = Vec3(0.0, 0.0, -0.1);
  }

  Dive run(const std::function<double(double, double)>& fault) {
    Gauge gauge;
    gauge.fault = fault;
    return dive(options_, gauge);
  }
  TestSceneOptions options_;
};

TEST_F(FaultyGauge, SpikesAreLeftOut) {
  int reading = 0, spikes = 0;
  const Dive result = run([&](double, double depth_m) {
    if (++reading % 8 != 0) return depth_m;
    ++spikes;
    return spikes % 2 ? 655.35 : depth_m - 1.0;
  });
  EXPECT_EQ(result.statuses.at(DepthStatus::Jump), spikes);
  EXPECT_LT(result.largestHeightError(0.0, kNever), 0.06);
}

TEST_F(FaultyGauge, NewZeroIsTakenForANewOffset) {
  const Dive result = run([](double t, double depth_m) { return t < 12.0 ? depth_m : depth_m + 3.0; });
  EXPECT_EQ(result.statuses.at(DepthStatus::Restarted), 1);
  EXPECT_EQ(result.last().sensors.of<DepthEstimate>().status == DepthStatus::Jump, false);
  EXPECT_LT(result.largestHeightError(0.0, kNever), 0.08);
  EXPECT_EQ(result.findings.at("pressure_restarted"), 1);
}

TEST_F(FaultyGauge, FrozenReadingsAreNoticedAndForgivenWhenTheyChange) {
  std::optional<double> stuck_m;
  const Dive result = run([&](double t, double depth_m) {
    if (t < 12.0 || t > 20.0) return depth_m;
    stuck_m = stuck_m.value_or(depth_m);
    return *stuck_m;
  });
  EXPECT_GT(result.statuses.at(DepthStatus::Frozen), 5);
  EXPECT_EQ(result.findings.count("pressure_frozen"), 1u);
  EXPECT_LT(result.largestHeightError(0.0, kNever), 0.08);
  int used_later = 0;
  for (const Comparison& c : result.frames)
    used_later += c.time_s > 21.0 && c.estimate.sensors.of<DepthEstimate>().status == DepthStatus::Used;
  EXPECT_GT(used_later, 20);
}

TEST_F(FaultyGauge, OtherUnitsAndSignsAreNamedAndDoLittleHarm) {
  const Dive without = dive(options_, std::nullopt);
  for (const double factor : {100.0, 9806.65, 0.0980665, -1.0}) {
    const Dive result = run([factor](double, double depth_m) { return factor * depth_m; });
    EXPECT_EQ(result.findings.count("pressure_slope"), 1u) << factor;
    EXPECT_LT(result.largestHeightError(0.0, kNever), without.largestHeightError(0.0, kNever) + 0.15)
        << factor;
  }
}

TEST_F(FaultyGauge, NoiseBeyondWhatItStatesIsLearnt) {
  Random random(3, "loud");
  const Dive result = run([&](double, double depth_m) { return depth_m + 0.1 * random.normal(); });
  EXPECT_LT(result.largestHeightError(0.0, kNever), 0.1);
}

TEST_F(FaultyGauge, NotANumberIsLeftOut) {
  const Dive result =
      run([](double t, double depth_m) { return std::fmod(t, 2.0) < 0.6 ? std::nan("") : depth_m; });
  EXPECT_GT(result.findings.at("pressure_invalid"), 5);
  EXPECT_LT(result.largestHeightError(0.0, kNever), 0.06);
}

TEST(DepthFusion, SwitchedOffItIsAsIfThereWereNone) {
  const TestSceneOptions options = sceneOptions(4.0);
  EstimatorOptions off = honestOptions(options);
  off.depth.use = false;
  const Dive with = dive(options, Gauge(), off);
  const Dive without = dive(options, std::nullopt);
  EXPECT_EQ(with.last().sensors.of<DepthEstimate>().status, DepthStatus::Off);
  EXPECT_EQ(without.last().sensors.of<DepthEstimate>().status, DepthStatus::NoData);
  EXPECT_EQ(with.last().covariance, without.last().covariance);
  EXPECT_EQ(with.last().state.world_from_body.translation, without.last().state.world_from_body.translation);
}

}  // namespace
}  // namespace lodeline
