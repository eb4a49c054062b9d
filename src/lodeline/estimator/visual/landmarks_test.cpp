#include "lodeline/estimator/visual/landmarks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

// Three keyframes 20 cm apart that look along the world's x axis, then a frame that is not a keyframe.
class LandmarksTest : public testing::Test {
 protected:
  LandmarksTest() {
    for (int i = 0; i < 4; ++i)
      test_.add(Rigid3(so3::exp(Vec3(0, 0, 0.03 * i)), Vec3(0.02 * i, -0.2 * i, 0.01 * i)), i < 3);
  }

  void seeInAll(TrackId track, const Vec3& point_W, Random* noise = nullptr) {
    for (const auto& frame : test_.window.frames()) {
      for (int camera = 0; camera < 2; ++camera) {
        const Vec2 error = noise ? Vec2(noise->normal(), noise->normal()) : Vec2::Zero();
        test_.see(track, point_W, *frame, camera, error);
      }
    }
  }
  int create() { return createLandmarks(test_.window, test_.factors, options_); }
  int clean() { return removeOutliers(test_.window, test_.factors, options_); }
  const FeatureTrack& track(TrackId id) const { return test_.window.tracks().at(id); }

  TestWindow test_;
  LandmarkOptions options_;
};

TEST_F(LandmarksTest, AreCreatedWhereThePointIs) {
  const Vec3 point_W(3.0, -0.5, 0.4);
  seeInAll(1, point_W);
  EXPECT_EQ(create(), 1);
  ASSERT_TRUE(track(1).landmark.has_value());
  EXPECT_EQ(track(1).landmark->host, 2) << "the newest keyframe that sees it";
  EXPECT_LT((test_.position(1) - point_W).norm(), 1e-9);
  EXPECT_EQ(create(), 0) << "nothing is created twice";
}

// With the intrinsics of the file, the error of the point would be 25 mm.
TEST_F(LandmarksTest, AreCreatedByTheLensThatTheWindowKnows) {
  const TestWindow::Lens lens = {0.006, -0.004, 2.5, -1.5, 0.008, -0.01, 0.002, -0.001, 0.0, 0.0};
  const Vec3 point_W(3.0, -0.9, 0.4);
  test_.calibrate(lens);
  for (const auto& frame : test_.window.frames()) {
    for (int camera = 0; camera < 2; ++camera) test_.seeThrough(lens, 1, point_W, *frame, camera);
  }
  ASSERT_EQ(create(), 1);
  EXPECT_LT((test_.position(1) - point_W).norm(), 0.002);
}

TEST_F(LandmarksTest, WithNoiseComeOutWithinTheirUncertainty) {
  // One-pixel noise, eight views over a baseline of 0.7 m at 3 m: sigma of the distance about
  // 3^2 / (458 * 0.25 * sqrt(8)) m = 2.8 cm; 4 sigma for the worst of 50.
  Random noise(5, "landmarks");
  for (int i = 0; i < 50; ++i) seeInAll(i, Vec3(3.0, -1.0 + 0.1 * (i % 10), 0.1 * (i / 10)), &noise);
  EXPECT_EQ(create(), 50);
  for (int i = 0; i < 50; ++i) {
    EXPECT_LT((test_.position(i) - Vec3(3.0, -1.0 + 0.1 * (i % 10), 0.1 * (i / 10))).norm(), 0.12) << i;
  }
}

TEST_F(LandmarksTest, NeedTwoObservationsAKeyframeAndTheNewestFrame) {
  const Vec3 point_W(3.0, -0.5, 0.0);
  const auto& frames = test_.window.frames();
  test_.see(1, point_W, *frames[3]);  // once
  test_.see(2, point_W, *frames[0]);  // not in the newest frame
  test_.see(2, point_W, *frames[1]);
  test_.see(3, point_W, *frames[3], 0);  // in none of the keyframes
  test_.see(3, point_W, *frames[3], 1);
  EXPECT_EQ(create(), 0);
}

// Any wrong match can be triangulated from two images.
TEST_F(LandmarksTest, NeedThreeFramesWhereTheWindowHasThem) {
  const Vec3 point_W(3.0, -0.5, 0.0);
  const auto& frames = test_.window.frames();
  for (int i = 2; i < 4; ++i) {
    test_.see(1, point_W, *frames[i], 0);
    test_.see(1, point_W, *frames[i], 1);
  }
  EXPECT_EQ(create(), 0);
  test_.see(2, point_W, *frames[1]);
  test_.see(2, point_W, *frames[2]);
  test_.see(2, point_W, *frames[3]);
  EXPECT_EQ(create(), 1);
  EXPECT_TRUE(track(2).landmark.has_value());

  TestWindow start;
  const Frame& first = start.add(Rigid3(), true);
  start.see(1, point_W, first, 0);
  start.see(1, point_W, first, 1);
  EXPECT_EQ(createLandmarks(start.window, start.factors, options_), 1) << "two cameras start at once";
}

TEST_F(LandmarksTest, BehindTheCameraOrTooNearAreRefused) {
  options_.min_frames = 2;
  // Diverging rays: the point would lie behind the camera.
  const auto& frames = test_.window.frames();
  test_.seeAlong(1, Vec3(-0.1, 0.0, 1.0), *frames[2], 0);
  test_.seeAlong(1, Vec3(0.1, 0.0, 1.0), *frames[2], 1);
  test_.see(1, Vec3(100.0, 0.0, 0.0), *frames[3]);
  // A point 2 cm in front of the camera, with a baseline across the line of sight.
  const Rigid3 world_from_camera = frames[2]->worldFromBody() * test_.rig.cameras[0].body_from_camera;
  const Vec3 near_W = world_from_camera * Vec3(0.0, 0.0, 0.02);
  test_.seeAlong(2, Vec3::UnitZ(), *frames[2]);
  test_.seeAlong(2, (frames[3]->worldFromBody() * test_.rig.cameras[0].body_from_camera).inverse() * near_W,
                 *frames[3]);
  EXPECT_EQ(create(), 0);
}

TEST_F(LandmarksTest, FarAwayKeepTheirDirection) {
  const Vec3 point_W(5e3, -400.0, 300.0);
  seeInAll(1, point_W);
  ASSERT_EQ(create(), 1);
  EXPECT_LT(track(1).landmark->inverseDistance(), 1e-3);
  EXPECT_LT(reprojectionStatistics(test_.window, test_.factors, 3).rms_sigmas, 0.1);
  EXPECT_EQ(clean(), 0);
}

// One camera that hardly moves among known landmarks observes 100 new points at the same distance.
class SlowLandmarksTest : public testing::Test {
 protected:
  static constexpr double kDistance_m = 3.0;
  static constexpr int kPoints = 100;

  explicit SlowLandmarksTest(int known = 10) {
    for (TrackId id = kPoints; id < kPoints + known; ++id) known_.push_back(id);
  }

  /// Number of points that become landmarks with frames `step_m` apart.
  int create(double step_m) {
    for (int i = 0; i < 4; ++i) test_.add(Rigid3(Quat::Identity(), Vec3(0.0, -step_m * i, 0.0)), i < 3);
    Random noise(5, "slow landmarks");
    const auto& frames = test_.window.frames();
    for (TrackId id = 0; id < kPoints; ++id) {
      for (const auto& frame : frames)
        test_.see(id, pointOf(id), *frame, 0, Vec2(noise.normal(), noise.normal()));
    }
    for (const TrackId id : known_) {
      for (const auto& frame : frames) test_.see(id, pointOf(id), *frame);
      test_.place(id, pointOf(id), *frames[2]);
    }
    return createLandmarks(test_.window, test_.factors, LandmarkOptions());
  }
  double meanInverseDistance() const {
    double sum = 0.0;
    int count = 0;
    for (const auto& [id, track] : test_.window.tracks()) {
      if (id >= kPoints || !track.landmark) continue;
      sum += track.landmark->inverseDistance();
      ++count;
    }
    return sum / count;
  }

  // Sigma of the inverse distance, host in the middle: 1 / (458 px * sqrt(6) * step).
  static double stepFor(double relative_sigma) {
    return kDistance_m / (relative_sigma * 458.0 * std::sqrt(6.0));
  }

  TestWindow test_{1};

 private:
  static Vec3 pointOf(TrackId id) {
    const double i = static_cast<double>(id % 10), j = static_cast<double>(id / 10 % 10);
    return Vec3(kDistance_m, -0.9 + 0.2 * i, -0.9 + 0.2 * j);
  }

  std::vector<TrackId> known_;
};

// Relative to their own distance, points that appear near by noise would be accurate enough.
TEST_F(SlowLandmarksTest, DoNotOweTheirPlaceToNoise) { EXPECT_EQ(create(stepFor(0.5)), 0); }

TEST_F(SlowLandmarksTest, LieWhereTheirPointsLieInTheMean) {
  ASSERT_GT(create(stepFor(0.3)), kPoints * 9 / 10);
  // 0.3 / sqrt(100) of it is one sigma.
  EXPECT_NEAR(meanInverseDistance() * kDistance_m, 1.0, 0.09);
}

class FirstLandmarksTest : public SlowLandmarksTest {
 protected:
  FirstLandmarksTest() : SlowLandmarksTest(0) {}
};

TEST_F(FirstLandmarksTest, AreMeasuredByThemselves) {
  const int created = create(stepFor(0.5));
  EXPECT_GT(created, 0);
  EXPECT_LT(created, kPoints / 2);
}

TEST_F(LandmarksTest, WhoseViewsContradictEachOtherAreRefused) {
  // 15 px across the epipolar lines; half of it is the mean error.
  for (const auto& frame : test_.window.frames())
    test_.see(1, Vec3(3.0, -0.5, 0.0), *frame, 0, Vec2(0.0, frame->id % 2 == 0 ? 15.0 : -15.0));
  EXPECT_EQ(create(), 0);
}

TEST_F(LandmarksTest, AreLimitedToThoseSeenLongest) {
  for (int i = 0; i < 10; ++i) seeInAll(i, Vec3(3.0, -1.0 + 0.1 * i, 0.0));
  const auto& frames = test_.window.frames();
  for (int i = 10; i < 20; ++i) {
    test_.see(i, Vec3(3.0, -1.0 + 0.1 * (i - 10), 0.2), *frames[1]);
    test_.see(i, Vec3(3.0, -1.0 + 0.1 * (i - 10), 0.2), *frames[2]);
    test_.see(i, Vec3(3.0, -1.0 + 0.1 * (i - 10), 0.2), *frames[3]);
  }
  options_.max_landmarks = 12;
  EXPECT_EQ(create(), 12);
  for (int i = 0; i < 12; ++i) EXPECT_TRUE(track(i).landmark.has_value()) << i;
  EXPECT_FALSE(track(12).landmark.has_value());
}

// After darkness the window is full of points that are not in view.
TEST_F(LandmarksTest, AreMadeWhenFewAreInViewHoweverManyTheWindowHolds) {
  const auto& frames = test_.window.frames();
  for (int i = 0; i < 12; ++i) {
    const Vec3 point_W(3.0, -1.0 + 0.1 * i, 0.0);
    test_.see(i, point_W, *frames[0]);
    test_.see(i, point_W, *frames[1]);
    test_.place(i, point_W, *frames[0]);
  }
  for (int i = 12; i < 20; ++i) seeInAll(i, Vec3(3.0, -1.0 + 0.1 * (i - 12), 0.2));
  options_.max_landmarks = 12;
  options_.least_in_view = 5;
  EXPECT_EQ(create(), 5);
  EXPECT_EQ(create(), 0);
}

TEST_F(LandmarksTest, LoseAObservationThatContradictsThem) {
  const Vec3 point_W(3.0, -0.5, 0.2);
  for (const auto& frame : test_.window.frames()) {
    const Vec2 error(frame->id == 1 ? 30.0 : 0.0, 0.0);
    test_.see(1, point_W, *frame, 0, error);
    test_.see(1, point_W, *frame, 1);
  }
  test_.place(1, point_W, *test_.window.frames()[2]);
  EXPECT_EQ(clean(), 1);
  EXPECT_EQ(track(1).observations.size(), 7u);
  EXPECT_EQ(track(1).find(1, 0), nullptr);
  EXPECT_TRUE(track(1).landmark.has_value());
  EXPECT_EQ(clean(), 0);
}

TEST_F(LandmarksTest, DisappearWhenTheirHostContradictsThemOrTheyFallBehind) {
  const Vec3 point_W(3.0, -0.5, 0.2);
  seeInAll(1, point_W);
  seeInAll(2, point_W);
  seeInAll(3, point_W);
  const Frame& host = *test_.window.frames()[2];
  test_.place(1, point_W, host).parameters[0] += 0.2;  // the host's own observation is 90 px off
  test_.place(2, point_W, host).parameters[2] = -0.3;  // behind
  test_.place(3, point_W, host);
  clean();
  EXPECT_EQ(test_.window.tracks().count(1), 0u);
  EXPECT_EQ(test_.window.tracks().count(2), 0u);
  EXPECT_TRUE(track(3).landmark.has_value());
}

TEST_F(LandmarksTest, StatisticsCountTheFramesOwnObservations) {
  Random noise(2, "landmarks");
  for (int i = 0; i < 100; ++i) {
    const Vec3 point_W(3.0, -1.0 + 0.1 * (i % 10), -0.5 + 0.1 * (i / 10));
    seeInAll(i, point_W, &noise);
    test_.place(i, point_W, *test_.window.frames()[2]);
  }
  // At the true poses, the whitened residuals are the noise: 400 numbers of unit variance; 4 sigma of their
  // root mean square is 0.14.
  const ReprojectionStatistics statistics = reprojectionStatistics(test_.window, test_.factors, 3);
  EXPECT_EQ(statistics.landmarks, 100);
  EXPECT_EQ(statistics.observations, 200);
  EXPECT_NEAR(statistics.rms_sigmas, 1.0, 0.14);
}

}  // namespace
}  // namespace lodeline
