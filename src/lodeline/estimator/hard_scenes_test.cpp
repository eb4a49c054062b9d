// Scenes in which visual odometry fails, as tracks of points. The state must continue, stay within its
// reported covariance, and recover within a second. For darkness and rest see estimator_test.cpp.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "lodeline/estimator/trials/scene.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

constexpr double kTrouble_s = 6.0;  // start of the difficulty, unless a scene states otherwise

class HardScene : public testing::TestWithParam<int> {
 protected:
  using Tamper = std::function<void(double time_s, SimulatedFrame& frame)>;

  HardScene() {
    options_.cameras = GetParam();
    options_.duration_s = 12.0;
    options_.points.tracks = GetParam() == 1 ? 90 : 40;
    options_.points.frame_rate_hz = 10.0;
  }

  void run(const Tamper& tamper = {}) {
    TestScene scene(options_);
    ComparedEstimator estimator(scene, honestOptions(options_));
    while (auto frame = scene.next()) {
      if (tamper) tamper(scene.secondsOf(frame->truth.time), *frame);
      frames_.push_back(estimator.add(*frame));
    }
    EXPECT_EQ(estimator.diagnostics().count("solver_failed"), 0);
    ASSERT_TRUE(frames_.back().initialized());
  }

  /// Checks position and each angle against four times the reported sigma. With one camera the scale's sigma
  /// is too small for some seconds after the start (docs/lab-notes/consistency.md), hence twice that.
  void expectWithinItsSigmas() const {
    const double limit = GetParam() == 1 ? 8.0 : 4.0;
    for (const Comparison& c : frames_) {
      if (c.time_s < kTrouble_s || !c.initialized()) continue;
      const Eigen::VectorXd variance = c.estimate.covariance.diagonal();
      ASSERT_LT(c.positionError(), limit * std::sqrt(variance.head<3>().sum())) << "at " << c.time_s << " s";
      for (int i = 3; i < 6; ++i)
        ASSERT_LT(std::abs(c.error[i]), limit * std::sqrt(variance[i])) << "at " << c.time_s << " s";
    }
  }
  void expectTracking(double from_s, double to_s = 1e9) const {
    for (const Comparison& c : frames_) {
      if (c.time_s >= from_s && c.time_s < to_s) {
        EXPECT_EQ(c.estimate.status, Status::Tracking) << "at " << c.time_s << " s";
      }
    }
  }
  /// Largest increase of the position error, m, after the given time.
  double largestErrorSince(double from_s) const {
    double largest_m = 0.0;
    const Comparison* first = nullptr;
    for (const Comparison& c : frames_) {
      if (c.time_s < from_s || !c.initialized()) continue;
      if (!first) first = &c;
      largest_m = std::max(largest_m, (c.error - first->error).head<3>().norm());
    }
    return largest_m;
  }

  TestSceneOptions options_;
  std::vector<Comparison> frames_;
};

TEST_P(HardScene, TwentyTracksAreEnough) {
  run([](double time_s, SimulatedFrame& frame) {
    if (time_s < kTrouble_s) return;
    std::vector<TrackId> seen;
    for (const FeatureObservation& o : frame.tracks.observations) {
      if (o.camera == 0) seen.push_back(o.track);
    }
    if (seen.size() <= 20) return;
    std::sort(seen.begin(), seen.end());
    std::erase_if(frame.tracks.observations, [&](const FeatureObservation& o) { return o.track > seen[19]; });
  });
  // With one camera new points become landmarks only after some motion; for a moment there may be fewer than
  // eight.
  const auto blind = std::count_if(frames_.begin(), frames_.end(), [](const Comparison& c) {
    return c.time_s >= kTrouble_s && c.estimate.status == Status::Inertial;
  });
  EXPECT_LE(blind, GetParam() == 1 ? 5 : 0);
  expectWithinItsSigmas();
  EXPECT_LT(largestErrorSince(kTrouble_s), 0.15);
}

TEST_P(HardScene, TurningOnTheSpotAddsNoWay) {
  options_.duration_s = 16.0;
  options_.on_the_spot = {{6.0, 1e9}};
  run();
  expectTracking(kTrouble_s);
  expectWithinItsSigmas();
  EXPECT_LT(largestErrorSince(9.0), 0.1);
}

TEST_P(HardScene, TurnsOfNinetyDegreesASecond) {
  options_.hurry_rad_per_s = 1.4;
  options_.points.frame_rate_hz = 15.0;
  options_.duration_s = 11.0;
  run();
  expectTracking(kTrouble_s);
  expectWithinItsSigmas();
  EXPECT_LT(largestErrorSince(kTrouble_s), 0.25);
}

TEST_P(HardScene, FortyOfAHundredFramesMissing) {
  options_.points.frame_rate_hz = 15.0;
  options_.points.dropped_frame_share = 0.4;
  run();
  expectTracking(kTrouble_s);
  expectWithinItsSigmas();
  EXPECT_LT(largestErrorSince(kTrouble_s), 0.2);
}

// An exposure jump: no track continues from one image to the next, three times.
TEST_P(HardScene, AllTracksLostAtOnce) {
  constexpr TrackId kApart = 1'000'000;
  run([](double time_s, SimulatedFrame& frame) {
    const int jumps = (time_s > 6.0) + (time_s > 7.5) + (time_s > 9.0);
    for (FeatureObservation& o : frame.tracks.observations) o.track += jumps * kApart;
  });
  for (const double jump_s : {6.0, 7.5, 9.0}) expectTracking(jump_s + 1.0, jump_s + 1.4);
  expectTracking(10.0);
  expectWithinItsSigmas();
  EXPECT_LT(largestErrorSince(kTrouble_s), 0.3);
}

// A quarter of the points, anywhere in the image, moves along together for three seconds; half of them for
// one, as with a hand in front of the lens.
TEST_P(HardScene, SomethingMovesThroughTheView) {
  run([](double time_s, SimulatedFrame& frame) {
    const bool fish = time_s > 6.0 && time_s < 9.0;
    const bool hand = time_s > 10.0 && time_s < 11.0;
    if (!fish && !hand) return;
    const double angle_rad = 0.1 * (time_s - (fish ? 6.0 : 10.0));
    const Quat turn = so3::exp(Vec3(0.3 * angle_rad, angle_rad, 0.0));
    for (FeatureObservation& o : frame.tracks.observations) {
      if (o.track % (fish ? 4 : 2) == 0) o.bearing_C = turn * o.bearing_C;
    }
  });
  expectTracking(kTrouble_s);
  expectWithinItsSigmas();
  EXPECT_LT(largestErrorSince(kTrouble_s), 0.15);
}

// The error of dead reckoning becomes known as soon as images determine the velocity again, and the position
// is corrected by it.
TEST_P(HardScene, InertialCovariancePropagationIsMadeGoodWhenImagesReturn) {
  constexpr double kLight_s = 26.0;
  options_.duration_s = 30.0;
  run([](double time_s, SimulatedFrame& frame) {
    if (time_s > kTrouble_s && time_s < kLight_s) frame.tracks.observations.clear();
  });
  double in_the_dark_m = 0.0;
  for (const Comparison& c : frames_) {
    if (c.time_s < kLight_s) in_the_dark_m = c.positionError();
  }
  EXPECT_LT(frames_.back().positionError(), 0.3 * in_the_dark_m) << in_the_dark_m << " m in the dark";
  expectWithinItsSigmas();
}

// The window has one keyframe, and the image information about the gyroscope bias is in later frames.
TEST(HardSceneOfTwoCameras, DarknessAfterRestLeavesWhatRestTold) {
  for (const uint64_t seed : {1, 2, 3, 4}) {
    TestSceneOptions options;
    options.seed = seed;
    options.duration_s = 13.0;
    options.still = {{-10.0, 1e9}};
    options.points.tracks = 40;
    options.points.frame_rate_hz = 10.0;
    TestScene scene(options);
    ComparedEstimator estimator(scene, honestOptions(options));
    while (auto frame = scene.next()) {
      if (scene.secondsOf(frame->truth.time) > 3.0) frame->tracks.observations.clear();
      const Comparison c = estimator.add(*frame);
      ASSERT_TRUE(c.initialized());
      const double reported_yaw_rad = std::sqrt(c.estimate.covariance(5, 5));
      EXPECT_LT(reported_yaw_rad, 0.02) << "seed " << seed << " at " << c.time_s << " s";
      EXPECT_LT(std::abs(c.error[5]), 4.0 * reported_yaw_rad)
          << "seed " << seed << " at " << c.time_s << " s";
    }
  }
}

/// Silt full of particles, or darkness full of the blocks of a compressed video. No point is the same in two
/// images. A tracker nevertheless finds a match at the position predicted by the rig's rotation, and in the
/// other camera's image at some distance.
class ChanceMatches {
 public:
  explicit ChanceMatches(int cameras) : rig_(testRig(cameras)) {}

  void replace(SimulatedFrame* frame) {
    const Quat world_from_camera =
        frame->truth.motion.world_from_body.rotation * rig_.cameras[0].body_from_camera.rotation;
    frame->tracks.observations.clear();
    for (const Match& match : last_) see(match, world_from_camera, frame);
    last_.clear();
    for (int i = 0; i < 50; ++i) {
      const Vec3 offset_C(random_.uniform(-0.3, 0.3), random_.uniform(-0.2, 0.2), 1.0);
      last_.push_back({next_++, world_from_camera * (random_.uniform(0.5, 3.0) * offset_C)});
      see(last_.back(), world_from_camera, frame);
    }
  }

 private:
  struct Match {
    TrackId track;
    Vec3 from_camera_W;  ///< m, from camera 0 at its present position
  };

  void see(const Match& match, const Quat& world_from_camera, SimulatedFrame* frame) {
    for (int camera = 0; camera < static_cast<int>(rig_.cameras.size()); ++camera) {
      const Rigid3 other_from_camera =
          rig_.cameras[camera].body_from_camera.inverse() * rig_.cameras[0].body_from_camera;
      FeatureObservation observation;
      observation.track = match.track;
      observation.camera = camera;
      const double focal_px = rig_.cameras[camera].fx_px;
      const Vec3 noise(random_.normal() / focal_px, random_.normal() / focal_px, 0.0);
      const Vec3 point_C = other_from_camera * (world_from_camera.conjugate() * match.from_camera_W);
      observation.bearing_C = (point_C.normalized() + noise).normalized();
      frame->tracks.observations.push_back(observation);
    }
  }

  Rig rig_;
  Random random_{3, "chance matches"};
  TrackId next_ = 2'000'000;
  std::vector<Match> last_;
};

TEST_P(HardScene, MatchesByChanceTellNothing) {
  options_.duration_s = 10.0;
  ChanceMatches chance(GetParam());
  run([&](double time_s, SimulatedFrame& frame) {
    if (time_s > 6.0 && time_s < 8.0) chance.replace(&frame);
  });
  for (const Comparison& c : frames_) {
    if (c.time_s > 6.3 && c.time_s < 8.0) {
      EXPECT_EQ(c.estimate.status, Status::Inertial) << "at " << c.time_s << " s";
    }
  }
  expectTracking(9.0);
  expectWithinItsSigmas();
}

INSTANTIATE_TEST_SUITE_P(StereoAndMono, HardScene, testing::Values(2, 1),
                         [](const auto& info) { return info.param == 2 ? "Stereo" : "Mono"; });

}  // namespace
}  // namespace lodeline
