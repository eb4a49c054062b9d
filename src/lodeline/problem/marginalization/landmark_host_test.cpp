#include <gtest/gtest.h>

#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/problem/marginalization/landmark_host.h"

namespace lodeline {
namespace {

class MoveToNewHostTest : public testing::Test {
 protected:
  MoveToNewHostTest() {
    for (int i = 0; i < 4; ++i)
      test_.add(Rigid3(so3::exp(Vec3(0.01, 0.02, 0.05 * i)), Vec3(0.1 * i, -0.2 * i, 0.0)), i != 3);
  }
  Landmark& landmark(TrackId id) { return *test_.window.tracks().at(id).landmark; }
  void move(TrackId id, FrameId excluded) {
    moveToNewHost(test_.window, test_.window.tracks().at(id), excluded, test_.factors);
  }
  Frame& frame(int i) { return *test_.window.frames()[i]; }

  TestWindow test_{1};
};

TEST_F(MoveToNewHostTest, KeepsThePoint) {
  const Vec3 point_W(4.0, 0.3, 0.5);
  // The ray of the new host has an error, which must not move the point.
  for (int i = 0; i < 4; ++i) test_.see(1, point_W, frame(i), 0, Vec2(3.0 * i, -2.0 * i));
  test_.place(1, point_W, frame(0));
  move(1, 0);
  EXPECT_EQ(landmark(1).host, 2) << "the newest keyframe, not the newest frame";
  EXPECT_LT((test_.position(1) - point_W).norm(), 1e-12);
  move(1, 2);
  EXPECT_EQ(landmark(1).host, 1);
  EXPECT_LT((test_.position(1) - point_W).norm(), 1e-12);
}

TEST_F(MoveToNewHostTest, MovesPointsAtInfinityToo) {
  const Vec3 far_W(1e6, 1e5, 0.0);
  for (int i = 0; i < 3; ++i) test_.see(1, far_W, frame(i));
  test_.place(1, far_W, frame(0)).parameters[2] = 0.0;
  move(1, 0);
  EXPECT_EQ(landmark(1).host, 2);
  EXPECT_NEAR(landmark(1).inverseDistance(), 0.0, 1e-12);
  const Vec3 direction_W = frame(2).worldFromBody().rotation *
                           test_.rig.cameras[0].body_from_camera.rotation *
                           landmark(1).base.direction(landmark(1).parameters.data());
  EXPECT_LT(direction_W.normalized().cross(far_W.normalized()).norm(), 1e-6);
}

TEST_F(MoveToNewHostTest, GivesUpALandmarkWithoutAHost) {
  const Vec3 point_W(4.0, 0.3, 0.5);
  test_.see(1, point_W, frame(0));
  test_.see(1, point_W, frame(3));  // not a keyframe
  test_.place(1, point_W, frame(0));
  move(1, 0);
  EXPECT_FALSE(test_.window.tracks().at(1).landmark.has_value());
  // Here the only other keyframe has moved past the point.
  test_.see(2, point_W, frame(0));
  test_.seeAlong(2, Vec3::UnitZ(), frame(1));
  test_.place(2, Vec3(0.1, 0.0, 0.0) + frame(0).worldFromBody().translation, frame(0));
  NavigationState past = frame(1).state();
  past.world_from_body.translation = Vec3(10.0, 0.0, 0.0);
  frame(1).setState(past);
  move(2, 0);
  EXPECT_FALSE(test_.window.tracks().at(2).landmark.has_value());
}

class TakeOlderPartTest : public testing::Test {
 protected:
  static constexpr TrackId kTrack = 1;
  static constexpr FrameId kLast = 4;
  TakeOlderPartTest() {
    for (int i = 0; i < 8; ++i)
      test_.add(Rigid3(so3::exp(Vec3(0.01, 0.02, 0.02 * i)), Vec3(0.1 * i, -0.1 * i, 0.0)), i % 2 == 0);
  }
  void seeFrom(int first, int end) {
    for (int i = first; i < end; ++i)
      test_.see(kTrack, kPoint_W, *test_.window.frames()[static_cast<size_t>(i)]);
  }
  FeatureTrack& track() { return test_.window.tracks().at(kTrack); }
  std::optional<FeatureTrack> take() { return splitTrack(test_.window, track(), kLast, test_.factors); }
  Vec3 position(const FeatureTrack& track) {
    return mapPointOf(test_.window, kTrack, track, test_.factors)->position_W;
  }

  const Vec3 kPoint_W{4.0, 0.3, 0.5};
  TestWindow test_{1};
};

TEST_F(TakeOlderPartTest, SharesOutObservationsAndKeepsThePoint) {
  seeFrom(0, 8);
  for (const int host : {0, 6}) {
    SCOPED_TRACE(host);
    track().observations.clear();
    seeFrom(0, 8);
    test_.place(kTrack, kPoint_W, *test_.window.frames()[static_cast<size_t>(host)]);
    const std::optional<FeatureTrack> older = take();
    ASSERT_TRUE(older.has_value());
    EXPECT_EQ(older->observations.size(), 5u);
    EXPECT_EQ(older->observations.back().frame, kLast);
    EXPECT_EQ(track().observations.size(), 3u);
    EXPECT_EQ(track().observations.front().frame, kLast + 1);
    EXPECT_EQ(older->landmark->host, host == 0 ? 0 : kLast);
    EXPECT_EQ(track().landmark->host, 6);
    EXPECT_LT((position(*older) - kPoint_W).norm(), 1e-12);
    EXPECT_LT((position(track()) - kPoint_W).norm(), 1e-12);
  }
}

TEST_F(TakeOlderPartTest, LeavesATrackAloneThatIsTooShortOnEitherSide) {
  const auto expectWhole = [&](size_t observations) {
    const FrameId host = track().landmark->host;
    EXPECT_FALSE(take().has_value());
    EXPECT_EQ(track().observations.size(), observations);
    EXPECT_EQ(track().landmark->host, host);
  };
  seeFrom(2, 8);  // three observations before the cut
  test_.place(kTrack, kPoint_W, *test_.window.frames()[2]);
  expectWhole(6);
  track().observations.clear();
  seeFrom(0, 6);  // one after it, not in a keyframe
  test_.place(kTrack, kPoint_W, *test_.window.frames()[2]);
  expectWhole(6);
  track().observations.clear();
  seeFrom(0, 6);  // two after it, neither in a keyframe
  seeFrom(7, 8);
  test_.place(kTrack, kPoint_W, *test_.window.frames()[2]);
  expectWhole(7);
}

TEST_F(MoveToNewHostTest, PointsTooFarAwayHaveNoPositionOnTheMap) {
  const Vec3 point_W(4.0, 0.3, 0.5);
  test_.see(1, point_W, frame(0));
  test_.place(1, point_W, frame(0));
  const FeatureTrack& track = test_.window.tracks().at(1);
  const auto point = mapPointOf(test_.window, 1, track, test_.factors);
  ASSERT_TRUE(point.has_value());
  EXPECT_EQ(point->track, 1);
  EXPECT_EQ(point->observations, 1);
  EXPECT_LT((point->position_W - point_W).norm(), 1e-12);
  landmark(1).parameters[2] = 5e-4;
  EXPECT_FALSE(mapPointOf(test_.window, 1, track, test_.factors).has_value());
}

}  // namespace
}  // namespace lodeline
