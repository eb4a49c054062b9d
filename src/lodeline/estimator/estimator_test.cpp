#include "lodeline/estimator/estimator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <set>

#include "lodeline/diagnostics.h"
#include "lodeline/estimator/trials/scene.h"

namespace lodeline {
namespace {

TestSceneOptions smallScene(int cameras, double duration_s) {
  TestSceneOptions options;
  options.cameras = cameras;
  options.duration_s = duration_s;
  options.points.tracks = cameras == 1 ? 100 : 60;  // a start without stereo asks for 40 that stay in view
  options.points.frame_rate_hz = 10.0;
  return options;
}

double positionSigma(const Comparison& c) {
  return std::sqrt(c.estimate.covariance.topLeftCorner<3, 3>().trace());
}

// Four times the claimed sigma of position (3 coordinates together) and of each angle: an honest estimator
// exceeds that in less than 1 of 1000 scenes.
void expectWithinItsSigmas(const Comparison& c) {
  EXPECT_LT(c.positionError(), 4.0 * positionSigma(c)) << "at " << c.time_s << " s";
  for (int i = 3; i < 6; ++i)
    EXPECT_LT(std::abs(c.error[i]), 4.0 * std::sqrt(c.estimate.covariance(i, i)))
        << "at " << c.time_s << " s";
}

void removeObservations(SimulatedFrame& frame, const std::function<bool(const FeatureObservation&)>& which) {
  std::erase_if(frame.tracks.observations, which);
}

class EstimatorSceneTest : public testing::Test {
 protected:
  using Tamper = std::function<void(double time_s, SimulatedFrame& frame)>;

  std::vector<Comparison> run(const TestSceneOptions& options, const Tamper& tamper = {}) {
    TestScene scene(options);
    ComparedEstimator estimator(scene, honestOptions(options));
    std::vector<Comparison> comparisons;
    while (auto frame = scene.next()) {
      if (tamper) tamper(scene.secondsOf(frame->truth.time), *frame);
      comparisons.push_back(estimator.add(*frame));
      keyframes_in_window_ = 0;
      for (const auto& kept : estimator.estimator().window().frames())
        keyframes_in_window_ += kept->is_keyframe;
    }
    EXPECT_EQ(estimator.diagnostics().count("solver_failed"), 0);
    return comparisons;
  }

  int keyframes_in_window_ = 0;  // at the end
};

TEST_F(EstimatorSceneTest, StereoStartsMovingAndStaysOnTrack) {
  const auto comparisons = run(smallScene(2, 10.0));
  for (const Comparison& c : comparisons) {
    EXPECT_EQ(c.estimate.status, Status::Tracking);
    EXPECT_GT(c.estimate.landmarks + 1, c.estimate.tracks / 2 * (c.time_s > 2.0));
    // 60 tracks of half a pixel for 9 s and 8 m: a centimetre or two, half a degree.
    EXPECT_LT(c.positionError(), 0.08) << "at " << c.time_s << " s";
    EXPECT_LT(c.rotationError(), 0.1) << "at " << c.time_s << " s";
  }
  expectWithinItsSigmas(comparisons.back());
  EXPECT_LT(comparisons.back().rotationError(), 0.015);
  EXPECT_NEAR(comparisons.back().estimate.reprojection_rms_sigmas, 1.0, 0.25);
}

// Its readings are as still as those of a rig at rest.
TEST_F(EstimatorSceneTest, StereoDoesNotTakeAGlideForRest) {
  TestSceneOptions options = smallScene(2, 3.0);
  options.liveliness = 0.05;
  options.drift_m_per_s = Vec3(0.2, 0.25, -0.05);
  const auto comparisons = run(options);
  for (const Comparison& c : comparisons) expectWithinItsSigmas(c);
  EXPECT_LT(comparisons.back().positionError(), 0.02);
}

TEST_F(EstimatorSceneTest, SaysWhenTheAccelerometersBiasIsImplausible) {
  const TestSceneOptions options = smallScene(2, 6.0);
  for (const double bias_m_per_s2 : {0.0, 3.0}) {
    TestScene scene(options);
    ComparedEstimator estimator(scene, {});
    while (auto frame = scene.next()) {
      for (ImuSample& sample : frame->imu) sample.specific_force_B.x() += bias_m_per_s2;
      estimator.add(*frame);
    }
    EXPECT_EQ(estimator.diagnostics().count("accelerometer_bias") > 0, bias_m_per_s2 > 0.0) << bias_m_per_s2;
  }
}

TEST_F(EstimatorSceneTest, StereoStartsAtRest) {
  TestSceneOptions options = smallScene(2, 10.0);
  options.still = {{-10.0, 16.0}};
  const auto comparisons = run(options);
  for (const Comparison& c : comparisons) {
    if (c.time_s > 3.0) continue;
    EXPECT_LT(c.positionError(), 0.01) << "at " << c.time_s << " s";
    EXPECT_EQ(c.estimate.is_keyframe, &c == &comparisons.front());
  }
  expectWithinItsSigmas(comparisons.back());
  EXPECT_LT(comparisons.back().positionError(), 0.05);
  EXPECT_LT(
      (comparisons.back().estimate.state.gyroscope_bias_B - comparisons.back().true_gyroscope_bias_B).norm(),
      2e-3);
}

TEST_F(EstimatorSceneTest, MonoFindsItsScale) {
  const auto comparisons = run(smallScene(1, 12.0));
  ASSERT_TRUE(comparisons.back().initialized());
  const auto started = std::find_if(comparisons.begin(), comparisons.end(),
                                    [](const Comparison& c) { return c.initialized(); });
  EXPECT_LT(started->time_s, 5.0);
  expectWithinItsSigmas(comparisons.back());
  // Least squares of true against estimated positions.
  double product = 0.0, square = 0.0;
  for (const Comparison& c : comparisons) {
    if (!c.initialized()) continue;
    product += c.true_world_from_body.translation.dot(c.estimate.state.world_from_body.translation);
    square += c.true_world_from_body.translation.squaredNorm();
  }
  EXPECT_NEAR(product / square, 1.0, 0.04);
}

void expectRest(const std::vector<Comparison>& comparisons, double still_from_s, double max_drift_m) {
  const Comparison* first = nullptr;
  for (const Comparison& c : comparisons) {
    if (c.time_s < still_from_s) continue;
    if (!first) first = &c;
    EXPECT_EQ(c.estimate.status, Status::Tracking) << "at " << c.time_s << " s";
    EXPECT_FALSE(c.estimate.is_keyframe) << "at " << c.time_s << " s";
    ASSERT_LT((c.error.head<3>() - first->error.head<3>()).norm(), max_drift_m) << "at " << c.time_s << " s";
    ASSERT_LT((c.error.tail<3>() - first->error.tail<3>()).norm(), 0.01) << "at " << c.time_s << " s";
    ASSERT_LT(c.estimate.state.velocity_W.norm(), 0.05) << "at " << c.time_s << " s";
  }
  expectWithinItsSigmas(comparisons.back());
}

TEST_F(EstimatorSceneTest, StandingStillForMinutesDriftsNowhere) {
  TestSceneOptions options = smallScene(2, 130.0);
  options.points.tracks = 40;
  options.points.frame_rate_hz = 5.0;
  options.points.longest_track_s = 1e9;
  options.still = {{6.0, 1e9}};
  const auto comparisons = run(options);
  expectRest(comparisons, 10.0, 0.02);
  EXPECT_GE(keyframes_in_window_, 5) << "the window must keep what it knows";
}

TEST_F(EstimatorSceneTest, StandingStillDriftsNowhereEvenWhereTracksComeAndGo) {
  TestSceneOptions options = smallScene(2, 50.0);
  options.points.tracks = 40;
  options.points.frame_rate_hz = 5.0;
  options.points.longest_track_s = 5.0;
  options.still = {{6.0, 1e9}};
  const auto comparisons = run(options);
  for (const Comparison& c : comparisons) {
    EXPECT_EQ(c.estimate.status, Status::Tracking) << "at " << c.time_s << " s";
    ASSERT_LT(c.positionError(), 0.1) << "at " << c.time_s << " s";
  }
  expectWithinItsSigmas(comparisons.back());
}

TEST_F(EstimatorSceneTest, MonoStandsStillAfterItHasMoved) {
  TestSceneOptions options = smallScene(1, 40.0);
  options.points.frame_rate_hz = 10.0;
  options.points.longest_track_s = 1e9;
  options.still = {{10.0, 1e9}};
  const auto comparisons = run(options);
  expectRest(comparisons, 14.0, 0.05);
}

TEST_F(EstimatorSceneTest, CarriesOnInertiallyThroughFiveSecondsOfDarkness) {
  for (const int cameras : {2, 1}) {
    TestSceneOptions options = smallScene(cameras, 20.0);
    options.points.blackouts = {{10.0, 5.0}};
    const auto comparisons = run(options);
    double sigma_before = 0.0;
    for (const Comparison& c : comparisons) {
      if (c.time_s > 9.0 && c.time_s < 9.99) {
        EXPECT_EQ(c.estimate.status, Status::Tracking);
      }
      if (c.time_s < 9.99 || c.time_s > 14.99) continue;
      EXPECT_EQ(c.estimate.status, Status::Inertial) << "at " << c.time_s << " s";
      EXPECT_GT(positionSigma(c), sigma_before) << "at " << c.time_s << " s";
      sigma_before = positionSigma(c);
      expectWithinItsSigmas(c);
    }
    // 5 s of dead reckoning: velocity sigma of a cm/s and tilt of a mrad (0.01 m/s^2) give decimetres.
    EXPECT_LT(sigma_before, 3.0);
    for (const Comparison& c : comparisons) {
      if (c.time_s > 16.0) {
        EXPECT_EQ(c.estimate.status, Status::Tracking) << "at " << c.time_s << " s";
      }
    }
    expectWithinItsSigmas(comparisons.back());
    EXPECT_LT((comparisons.back().estimate.state.velocity_W - comparisons.back().true_velocity_W).norm(),
              0.2);
  }
}

TEST_F(EstimatorSceneTest, BridgesAGapInTheInertialReadings) {
  const auto comparisons = run(smallScene(2, 10.0), [](double time_s, SimulatedFrame& frame) {
    if (time_s > 5.0 && time_s < 5.55) frame.imu = {frame.imu.front(), frame.imu.back()};
  });
  for (const Comparison& c : comparisons) {
    EXPECT_EQ(c.estimate.status, Status::Tracking);
    EXPECT_LT(c.positionError(), 0.1) << "at " << c.time_s << " s";
  }
  expectWithinItsSigmas(comparisons.back());
}

TEST_F(EstimatorSceneTest, DoesWithoutTheRightCameraForAWhile) {
  const auto comparisons = run(smallScene(2, 12.0), [](double time_s, SimulatedFrame& frame) {
    if (time_s > 4.0 && time_s < 9.0)
      removeObservations(frame, [](const FeatureObservation& o) { return o.camera == 1; });
  });
  for (const Comparison& c : comparisons) {
    EXPECT_EQ(c.estimate.status, Status::Tracking);
    EXPECT_LT(c.positionError(), 0.1) << "at " << c.time_s << " s";
  }
  expectWithinItsSigmas(comparisons.back());
}

TEST_F(EstimatorSceneTest, StartsWithOneCameraWhereTheOtherIsMissing) {
  const auto comparisons = run(smallScene(2, 10.0), [](double, SimulatedFrame& frame) {
    removeObservations(frame, [](const FeatureObservation& o) { return o.camera == 1; });
  });
  EXPECT_THAT(comparisons.front().estimate.waiting_for, testing::HasSubstr("stereo matches 0 of 20"));
  ASSERT_TRUE(comparisons.back().initialized());
  expectWithinItsSigmas(comparisons.back());
}

TEST_F(EstimatorSceneTest, WaitsOutFramesWithoutObservations) {
  const auto comparisons = run(smallScene(2, 4.0), [](double time_s, SimulatedFrame& frame) {
    if (time_s < 1.55) frame.tracks.observations.clear();
  });
  for (const Comparison& c : comparisons) {
    EXPECT_EQ(c.initialized(), c.time_s > 1.55) << "at " << c.time_s << " s";
    EXPECT_EQ(c.estimate.waiting_for.empty(), c.initialized());
  }
  EXPECT_LT(comparisons.back().positionError(), 0.05);
}

TEST_F(EstimatorSceneTest, SurvivesAFrameOfOutliersOnly) {
  Random random(4, "outliers");
  const auto comparisons = run(smallScene(2, 10.0), [&](double time_s, SimulatedFrame& frame) {
    if (std::abs(time_s - 5.0) > 0.01) return;
    for (FeatureObservation& o : frame.tracks.observations) {
      o.bearing_C = Vec3(random.uniform(-0.6, 0.6), random.uniform(-0.4, 0.4), 1.0).normalized();
    }
  });
  // One second later nothing is left of it.
  for (const Comparison& c : comparisons) {
    if (c.time_s < 4.95 || c.time_s > 6.0) {
      EXPECT_LT(c.positionError(), 0.1) << "at " << c.time_s << " s";
    }
  }
  expectWithinItsSigmas(comparisons.back());
}

TEST_F(EstimatorSceneTest, BearsATenthOfOutliersAndTracksThatFlicker) {
  Random random(4, "flicker");
  TestSceneOptions options = smallScene(2, 10.0);
  options.points.tracks = 100;
  options.points.outlier_share = 0.1;
  const auto comparisons = run(options, [&](double, SimulatedFrame& frame) {
    removeObservations(frame, [&](const FeatureObservation&) { return random.chance(0.3); });
  });
  for (const Comparison& c : comparisons) EXPECT_LT(c.positionError(), 0.15) << "at " << c.time_s << " s";
  EXPECT_EQ(comparisons.back().estimate.status, Status::Tracking);
}

TEST(Estimator, GivesTheSameBitsTwice) {
  for (const int cameras : {2, 1}) {
    const TestSceneOptions options = smallScene(cameras, 7.0);
    TestScene scene(options);
    Diagnostics diagnostics;
    Estimator a(scene.rig(), honestOptions(options), &diagnostics);
    // Other addresses on the heap must not show.
    std::vector<std::unique_ptr<std::array<char, 1000>>> clutter(10);
    Estimator b(scene.rig(), honestOptions(options), &diagnostics);
    int compared = 0;
    while (const auto frame = scene.next()) {
      const FrameEstimate from_a = a.add(frame->tracks, frame->imu);
      clutter.push_back(std::make_unique<std::array<char, 1000>>());
      const FrameEstimate from_b = b.add(frame->tracks, frame->imu);
      ASSERT_EQ(from_a.status, from_b.status);
      ASSERT_EQ(from_a.waiting_for, from_b.waiting_for);
      if (from_a.status == Status::Waiting) continue;
      ASSERT_EQ(from_a.state.world_from_body.translation, from_b.state.world_from_body.translation);
      ASSERT_EQ(from_a.state.world_from_body.rotation.coeffs(),
                from_b.state.world_from_body.rotation.coeffs());
      ASSERT_EQ(from_a.state.velocity_W, from_b.state.velocity_W);
      ASSERT_EQ(from_a.state.accelerometer_bias_B, from_b.state.accelerometer_bias_B);
      ASSERT_EQ(from_a.covariance, from_b.covariance);
      ++compared;
    }
    EXPECT_GT(compared, 15) << cameras << " cameras";
  }
}

TEST(Estimator, RefusesWhatDoesNotFollowOnAndCarriesOn) {
  const TestSceneOptions options = smallScene(2, 4.0);
  TestScene scene(options);
  ComparedEstimator compared(scene, honestOptions(options));
  std::vector<SimulatedFrame> frames = scene.all();
  for (int i = 0; i < 10; ++i) compared.add(frames[i]);
  SimulatedFrame without_imu = frames[10];
  without_imu.imu.clear();
  EXPECT_THROW(compared.add(without_imu), InputError);
  EXPECT_THROW(compared.add(frames[3]), InputError) << "back in time";
  EXPECT_THROW(compared.add(frames[9]), InputError) << "twice";
  EXPECT_THROW(compared.add(frames[11]), InputError) << "readings of the interval before are missing";
  SimulatedFrame spoilt = frames[10];
  spoilt.imu[2].angular_velocity_B.x() = std::nan("");
  EXPECT_THROW(compared.add(spoilt), InputError);
  Comparison last;
  for (size_t i = 10; i < frames.size(); ++i) last = compared.add(frames[i]);
  EXPECT_LT(last.positionError(), 0.05);
}

TEST(Estimator, HandsOutEveryLandmarkOfTheMapOnce) {
  TestSceneOptions options = smallScene(2, 8.0);
  TestScene scene(options);
  Diagnostics diagnostics;
  Estimator estimator(scene.rig(), honestOptions(options), &diagnostics);
  std::set<TrackId> left, present;
  while (const auto frame = scene.next()) {
    estimator.add(frame->tracks, frame->imu);
    for (const MapPoint& point : estimator.takeMapPoints()) left.insert(point.track);
  }
  for (const MapPoint& point : estimator.currentMapPoints()) {
    EXPECT_TRUE(present.insert(point.track).second);
    EXPECT_TRUE(point.position_W.allFinite());
  }
  EXPECT_GT(present.size(), 30u);
  EXPECT_GT(left.size(), 10u);
}

}  // namespace
}  // namespace lodeline
