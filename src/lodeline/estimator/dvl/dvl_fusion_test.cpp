#include "lodeline/estimator/dvl/dvl_fusion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "lodeline/estimator/trials/scene_dvl.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

struct Dive {
  std::vector<Comparison> frames;
  std::map<DvlStatus, int> statuses;
  std::map<std::string, int64_t> findings;
  int beams = 0, used = 0;

  const FrameEstimate& last() const { return frames.back().estimate; }
  const DvlEstimate& dvl() const { return last().sensors.of<DvlEstimate>(); }
  /// Mean square of the position errors in a time span, m^2.
  double meanSquare(double from_s, double to_s) const {
    double sum = 0.0;
    int count = 0;
    for (const Comparison& c : frames) {
      if (!c.initialized() || c.time_s < from_s || c.time_s >= to_s) continue;
      sum += c.error.head<3>().squaredNorm();
      ++count;
    }
    return sum / count;
  }
  const Comparison& at(double time_s) const {
    return *std::find_if(frames.begin(), frames.end(),
                         [&](const Comparison& c) { return c.time_s >= time_s; });
  }
};

TestSceneOptions sceneOptions(double duration_s, int cameras = 2) {
  TestSceneOptions options;
  options.cameras = cameras;
  options.duration_s = duration_s;
  options.points.tracks = cameras == 1 ? 80 : 40;
  options.points.frame_rate_hz = 8.0;
  return options;
}

EstimatorOptions exactCameras(const TestSceneOptions& scene) {
  EstimatorOptions options = honestOptions(scene);
  options.camera_calibration.enabled = false;
  return options;
}

using Change = std::function<void(DvlCalibration*)>;

Dive dive(const TestSceneOptions& options, const std::optional<SceneDvlErrors>& errors,
          const EstimatorOptions& estimator, const Change& change = {}) {
  TestScene scene(options);
  Rig rig = scene.rig();
  rig.dvl = SceneDvl::lookingDown();
  if (change) change(&*rig.dvl);
  ComparedEstimator compared(scene, estimator, rig);
  SceneDvl dvl(scene, *rig.dvl, options, errors.value_or(SceneDvlErrors()));
  Dive result;
  while (const auto frame = scene.next()) {
    std::vector<DvlSample> pings = dvl.until(frame->truth.time);
    if (!errors) pings.clear();
    result.frames.push_back(compared.add(*frame, SensorReadings(std::move(pings))));
    const DvlEstimate& estimate = result.dvl();
    ++result.statuses[estimate.status];
    result.beams += estimate.beams;
    result.used += estimate.used;
  }
  for (const Finding& finding : compared.diagnostics().ranked())
    result.findings[finding.kind] = finding.count;
  return result;
}

Dive dive(const TestSceneOptions& options, const std::optional<SceneDvlErrors>& errors) {
  return dive(options, errors, exactCameras(options));
}

/// 1 % and 3 degrees.
SceneDvlErrors wrongCalibration() {
  SceneDvlErrors errors;
  errors.scale = 0.01;
  errors.misalignment_rad = 3.0 / kDegreesPerRadian * Vec3(0.5, -0.4, 0.77).normalized();
  return errors;
}

TEST(DvlFusion, FindsScaleAndMisalignment) {
  for (const bool has_beams : {true, false}) {
    SceneDvlErrors errors = wrongCalibration();
    errors.has_beams = has_beams;
    errors.noise_m_per_s = has_beams ? 0.005 : 0.01;
    const TestSceneOptions options = sceneOptions(50.0);
    const Dive found = dive(options, errors, exactCameras(options), [&](DvlCalibration* dvl) {
      dvl->velocity_noise_std_m_per_s = errors.noise_m_per_s;
    });
    const Vec3 turn_error = found.dvl().misalignment_rad - errors.misalignment_rad;
    RecordProperty(has_beams ? "beams_scale_error" : "velocity_scale_error",
                   std::to_string(found.dvl().scale - errors.scale));
    RecordProperty(has_beams ? "beams_turn_error_deg" : "velocity_turn_error_deg",
                   std::to_string(turn_error.norm() * kDegreesPerRadian));
    EXPECT_NEAR(found.dvl().scale, errors.scale, 0.001) << has_beams;
    EXPECT_LT(turn_error.norm() * kDegreesPerRadian, 0.1) << has_beams;
    EXPECT_LT(found.dvl().scale_sigma, 0.001);
    EXPECT_LT(found.dvl().misalignment_sigma_rad * kDegreesPerRadian, 0.1);
    EXPECT_LT(std::abs(found.dvl().scale - errors.scale), 4.0 * found.dvl().scale_sigma);
    EXPECT_GT(found.used, 0.97 * found.beams);
    EXPECT_TRUE(found.findings.empty()) << found.findings.begin()->first;
  }
}

TEST(DvlFusion, WrongCalibrationCostsLittleInTheDark) {
  double wrong = 0.0, right = 0.0;
  for (const uint64_t seed : {1, 2, 3, 4}) {
    TestSceneOptions options = sceneOptions(50.0);
    options.seed = seed;
    options.points.blackouts = {{30.0, 30.0}};
    right += dive(options, SceneDvlErrors()).meanSquare(30.0, 50.0);
    wrong += dive(options, wrongCalibration()).meanSquare(30.0, 50.0);
  }
  RecordProperty("ratio", std::to_string(std::sqrt(wrong / right)));
  EXPECT_LT(std::sqrt(wrong), 1.1 * std::sqrt(right));
}

TEST(DvlFusion, MissingBeamsAndSentinelsCostLittle) {
  double spoiled = 0.0, clean = 0.0;
  for (const uint64_t seed : {1, 2, 3, 4}) {
    TestSceneOptions options = sceneOptions(25.0, 1);
    options.seed = seed;
    SceneDvlErrors errors;
    clean += dive(options, errors).meanSquare(5.0, 25.0);
    errors.missing_share = 0.5;
    errors.sentinel_share = 0.1;
    const Dive result = dive(options, errors);
    spoiled += result.meanSquare(5.0, 25.0);
    EXPECT_LT(result.used, 0.97 * result.beams);
    EXPECT_GT(result.used, 0.75 * result.beams);
  }
  RecordProperty("ratio", std::to_string(std::sqrt(spoiled / clean)));
  EXPECT_LT(std::sqrt(spoiled), 1.2 * std::sqrt(clean));
}

TEST(DvlFusion, CarriesTheRigThroughAMinuteOfDarkness) {
  for (const int cameras : {1, 2}) {
    TestSceneOptions options = sceneOptions(85.0, cameras);
    options.drift_m_per_s = Vec3(0.02, 0.0, 0.0);
    options.liveliness = 0.5;
    options.points.blackouts = {{20.0, 60.0}};
    const Dive with = dive(options, SceneDvlErrors());
    const Comparison &light = with.at(19.8), &dark = with.at(79.8);
    const double drift_m = (dark.error.head<3>() - light.error.head<3>()).norm();
    RecordProperty("drift_m_" + std::to_string(cameras), std::to_string(drift_m));
    EXPECT_EQ(dark.estimate.mode, Mode::InertialOnly);
    EXPECT_LT(drift_m, 0.3);
    const double sigma_m = std::sqrt(dark.estimate.covariance.topLeftCorner<3, 3>().trace());
    RecordProperty("sigma_m_" + std::to_string(cameras), std::to_string(sigma_m));
    EXPECT_LT(sigma_m, 0.5) << "the reported covariance knows of the DVL";
    EXPECT_LT(dark.positionError(), 4.0 * sigma_m);
    for (const Comparison& c : with.frames) {
      if (c.time_s > 80.5) {
        EXPECT_NE(c.estimate.mode, Mode::Recovering) << "the scale is not lost";
      }
    }
    EXPECT_LT(with.frames.back().positionError(), 0.4);
    const Dive without = dive(options, std::nullopt);
    EXPECT_GT(without.at(79.8).positionError(), 3.0) << "too easy a scene";
  }
}

// Without acceleration, inertial readings do not tell the scale of one camera.
TEST(DvlFusion, StartsOneCameraInASteadyGlide) {
  for (const uint64_t seed : {1, 2, 3}) {
    TestSceneOptions options = sceneOptions(5.0, 1);
    options.seed = seed;
    options.liveliness = 0.0;
    options.drift_m_per_s = Vec3(0.1, 0.5, 0.1);
    options.points.tracks = 100;
    EXPECT_FALSE(dive(options, std::nullopt).frames.back().initialized());
    for (const double missing : {0.0, 0.25}) {
      SceneDvlErrors errors;
      errors.missing_share = missing;
      errors.sentinel_share = 0.2 * missing;
      const Dive with = dive(options, errors);
      const Comparison& last = with.frames.back();
      ASSERT_TRUE(last.initialized()) << last.estimate.waiting_for;
      EXPECT_NEAR(last.estimate.state.velocity_W.norm() / last.true_velocity_W.norm(), 1.0, 0.02) << missing;
      EXPECT_LT(last.rotationError(), 0.05);
    }
  }
}

void expectSame(const Dive& a, const Dive& b) {
  EXPECT_EQ(a.last().state.world_from_body.translation, b.last().state.world_from_body.translation);
  EXPECT_EQ(a.last().covariance, b.last().covariance);
}

TEST(DvlFusion, WhatNoInstrumentMeasuresIsLeftOutAndReported) {
  const TestSceneOptions options = sceneOptions(6.0);
  SceneDvlErrors errors;
  errors.spoil = [](double time_s, DvlSample* sample) {
    constexpr double kNone[] = {0.0, std::numeric_limits<double>::quiet_NaN(), -32.768};
    for (DvlBeam& beam : sample->beams) beam.velocity_m_per_s = kNone[static_cast<int>(8.0 * time_s) % 3];
  };
  const Dive nothing = dive(options, errors);
  EXPECT_EQ(nothing.used, 0);
  EXPECT_GT(nothing.statuses.at(DvlStatus::Invalid), 30);
  EXPECT_GT(nothing.findings.at("dvl_invalid"), 30);
  expectSame(nothing, dive(options, std::nullopt));
}

/// A current that changes slowly, m/s.
Vec3 slowCurrent_W(double time_s) {
  const double phase = 2.0 * M_PI * time_s / 200.0;
  return Vec3(0.15 + 0.02 * std::sin(phase), -0.1 + 0.015 * std::cos(phase), 0.01);
}

// Images see the first 20 s.
TestSceneOptions sceneThatGoesDark(double duration_s) {
  TestSceneOptions options = sceneOptions(duration_s, 1);
  options.drift_m_per_s = Vec3(0.02, 0.0, 0.0);
  options.liveliness = 0.5;
  options.points.blackouts = {{20.0, duration_s}};
  return options;
}

TEST(DvlFusion, WaterTrackBoundsTheDriftInTheDarkByTheChangeOfTheCurrent) {
  const TestSceneOptions options = sceneThatGoesDark(80.0);
  SceneDvlErrors errors;
  errors.current_W = slowCurrent_W;
  const Dive water = dive(options, errors), without = dive(options, std::nullopt);
  const DvlEstimate& at_dusk = water.at(19.8).estimate.sensors.of<DvlEstimate>();
  ASSERT_TRUE(at_dusk.current_W);
  const double current_error_m_per_s = (*at_dusk.current_W - slowCurrent_W(19.8)).norm();
  const Comparison& last = water.frames.back();
  const double sigma_m = std::sqrt(last.estimate.covariance.topLeftCorner<3, 3>().trace());
  RecordProperty("drift_m", std::to_string(last.positionError()));
  RecordProperty("drift_without_m", std::to_string(without.frames.back().positionError()));
  RecordProperty("current_error_mm_per_s", std::to_string(1e3 * current_error_m_per_s));
  RecordProperty("sigma_m", std::to_string(sigma_m));
  EXPECT_GT(water.statuses.at(DvlStatus::WaterTrack), 400);
  EXPECT_EQ(water.statuses.count(DvlStatus::Used), 0u);
  EXPECT_EQ(water.findings.count("dvl_water_track"), 1u);
  EXPECT_LT(current_error_m_per_s, 0.03);
  EXPECT_LT(current_error_m_per_s, 4.0 * at_dusk.current_sigma_m_per_s);
  EXPECT_LT(last.positionError(), 0.05 * without.frames.back().positionError());
  EXPECT_LT(last.positionError(), 4.0 * sigma_m) << "the reported covariance knows of the current";
  EXPECT_FALSE(without.dvl().current_W);
}

// The current is learnt at the first velocity through the water, because the velocity of the rig is known
// then.
TEST(DvlFusion, WaterTrackCarriesOnWhereTheBottomIsLost) {
  constexpr double kLost_s = 25.0;
  const TestSceneOptions options = sceneThatGoesDark(75.0);
  SceneDvlErrors bottom, both;
  bottom.spoil = [](double time_s, DvlSample* sample) {
    if (time_s > kLost_s) sample->beams.clear();
  };
  both.current_W = [](double time_s) {
    return time_s > kLost_s ? slowCurrent_W(time_s) : Vec3(0.0, 0.0, 0.0);
  };
  both.spoil = [](double time_s, DvlSample* sample) {
    if (time_s <= kLost_s) sample->track = DvlTrack::Bottom;
  };
  const Dive lost = dive(options, bottom), carried = dive(options, both);
  const double lost_m = lost.frames.back().positionError();
  const double carried_m = carried.frames.back().positionError();
  RecordProperty("lost_m", std::to_string(lost_m));
  RecordProperty("carried_m", std::to_string(carried_m));
  EXPECT_EQ(lost.statuses.count(DvlStatus::WaterTrack), 0u);
  EXPECT_GT(carried.statuses.at(DvlStatus::WaterTrack), 300);
  EXPECT_GT(carried.statuses.at(DvlStatus::Used), 100);
  EXPECT_LT(carried_m, 0.1 * lost_m);
}

// The start needs the velocity over the bottom: without acceleration, nothing else tells the scale.
TEST(DvlFusion, WaterTrackDoesNotStartOneCamera) {
  TestSceneOptions options = sceneOptions(5.0, 1);
  options.liveliness = 0.0;
  options.drift_m_per_s = Vec3(0.1, 0.5, 0.1);
  options.points.tracks = 100;
  SceneDvlErrors errors;
  errors.current_W = slowCurrent_W;
  EXPECT_FALSE(dive(options, errors).frames.back().initialized());
}

TEST(DvlFusion, WrongMountingIsReportedAndItsHarmIsBounded) {
  const TestSceneOptions options = sceneOptions(25.0);
  SceneDvlErrors errors;
  errors.misalignment_rad = Vec3(0.0, 0.0, M_PI_2);
  const Dive wrong = dive(options, errors), without = dive(options, std::nullopt);
  EXPECT_EQ(wrong.findings.count("dvl_rejected"), 1u);
  EXPECT_LT(std::sqrt(without.meanSquare(0.0, 25.0)), 0.02);
  EXPECT_LT(std::sqrt(wrong.meanSquare(0.0, 25.0)), 1.1 * std::sqrt(without.meanSquare(0.0, 25.0)) + 0.02);
}

// A prediction that is wrong by more than its covariance must not lock the sensor out for ever.
TEST(DvlFusion, ReadingsThatDisagreeForLongAreUsedAgain) {
  const TestSceneOptions options = sceneOptions(25.0);
  SceneDvlErrors errors;
  errors.spoil = [](double time_s, DvlSample* sample) {
    for (DvlBeam& beam : sample->beams)
      beam.velocity_m_per_s = *beam.velocity_m_per_s + (time_s > 5.0 ? 1.0 : 0.0);
  };
  const Dive result = dive(options, errors);
  EXPECT_GT(result.statuses.at(DvlStatus::Rejected), 70);
  EXPECT_GT(result.statuses.at(DvlStatus::Readmitted), 70);
  EXPECT_EQ(result.findings.count("dvl_readmitted"), 1u);
  EXPECT_LT(result.frames.back().positionError(), 0.2) << "images know better";
}

TEST(DvlFusion, CalibrationThatIsOffByMoreThanItSaysIsReported) {
  SceneDvlErrors errors = wrongCalibration();
  errors.scale = 0.03;
  const TestSceneOptions options = sceneOptions(20.0);
  const Dive result =
      dive(options, errors, exactCameras(options), [](DvlCalibration* dvl) { dvl->scale_sigma = 0.005; });
  EXPECT_EQ(result.findings.count("dvl_calibration"), 1u);
}

TEST(DvlFusion, SwitchedOffItIsAsIfThereWereNone) {
  const TestSceneOptions options = sceneOptions(4.0);
  EstimatorOptions off = exactCameras(options);
  off.dvl.use = false;
  const Dive with = dive(options, SceneDvlErrors(), off);
  EXPECT_EQ(with.dvl().status, DvlStatus::Off);
  TestScene scene(options);
  const std::vector<Comparison> without = compare(scene, exactCameras(options));
  EXPECT_EQ(with.last().state.world_from_body.translation,
            without.back().estimate.state.world_from_body.translation);
  EXPECT_EQ(with.last().covariance, without.back().estimate.covariance);
}

TEST(DvlFusion, SaysInItsRowWhatItDid) {
  const TestSceneOptions options = sceneOptions(5.0);
  const Dive result = dive(options, SceneDvlErrors());
  const auto row = std::find_if(result.last().sensor_rows.begin(), result.last().sensor_rows.end(),
                                [](const SensorRow& r) { return r.sensor == "dvl"; });
  ASSERT_NE(row, result.last().sensor_rows.end());
  EXPECT_EQ(row->status, "used");
  EXPECT_EQ(row->columns.front().first, "dvl");
  EXPECT_EQ(row->columns[2], (std::pair<std::string, std::string>("dvl_used", "4")));
}

TEST(DvlOptions, RefusesValuesOutOfTheirRanges) {
  EXPECT_NO_THROW(DvlOptions().check());
  const auto refuses = [](double DvlOptions::*member, double value) {
    DvlOptions options;
    options.*member = value;
    EXPECT_THROW(options.check(), UsageError) << value;
    EstimatorOptions all;
    all.dvl = options;
    EXPECT_THROW(all.check(), UsageError) << value;
  };
  refuses(&DvlOptions::noise_inflation, 0.0);
  refuses(&DvlOptions::scale_walk_per_sqrt_s, -1.0);
  refuses(&DvlOptions::max_sigmas, std::numeric_limits<double>::quiet_NaN());
  refuses(&DvlOptions::readmission_s, -3.0);
}

}  // namespace
}  // namespace lodeline
