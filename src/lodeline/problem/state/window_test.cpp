#include "lodeline/problem/state/window.h"

#include <gtest/gtest.h>

#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

TEST(Frame, KeepsTheStateItIsGiven) {
  NavigationState state;
  state.time = Time::fromNanoseconds(1'800'000'000'123'456'789);
  state.world_from_body = Rigid3(so3::exp(Vec3(0.3, -0.2, 2.0)), Vec3(1, 2, 3));
  state.velocity_W = Vec3(4, 5, 6);
  state.gyroscope_bias_B = Vec3(0.1, 0.2, 0.3);
  state.accelerometer_bias_B = Vec3(-0.1, -0.2, -0.3);
  Frame frame;
  frame.setState(state);
  const NavigationState again = frame.state();
  EXPECT_EQ(again.time, state.time);
  EXPECT_EQ(again.world_from_body.translation, state.world_from_body.translation);
  EXPECT_LT(again.world_from_body.rotation.angularDistance(state.world_from_body.rotation), 1e-15);
  EXPECT_EQ(again.velocity_W, state.velocity_W);
  EXPECT_EQ(again.gyroscope_bias_B, state.gyroscope_bias_B);
  EXPECT_EQ(again.accelerometer_bias_B, state.accelerometer_bias_B);
}

class WindowTest : public testing::Test {
 protected:
  WindowTest() {
    for (int i = 0; i < 5; ++i) test_.add(Rigid3(), i == 0 || i == 2);
    test_.window.frames()[0]->has_motion = false;
    for (int i = 0; i < 5; ++i) test_.seeAlong(10, Vec3::UnitZ(), *window_.frames()[i]);
    test_.seeAlong(11, Vec3::UnitZ(), *window_.frames()[1]);
    test_.seeAlong(11, Vec3::UnitZ(), *window_.frames()[1], 1);
  }

  TestWindow test_;
  Window& window_ = test_.window;
};

TEST_F(WindowTest, FindsFramesByIdentity) {
  for (FrameId id = 0; id < 5; ++id) EXPECT_EQ(window_.find(id), window_.frames()[id].get());
  EXPECT_EQ(window_.find(-1), nullptr);
  EXPECT_EQ(window_.find(5), nullptr);
  window_.remove(3);
  EXPECT_EQ(window_.find(3), nullptr);
  EXPECT_EQ(window_.find(4), &window_.newest());
}

TEST_F(WindowTest, KnowsWhichFramesAreOldRecentAndKey) {
  EXPECT_EQ(window_.recentCount(), 4);
  EXPECT_EQ(window_.poseOnlyCount(), 1);
  EXPECT_EQ(window_.newestKeyframe()->id, 2);
  EXPECT_EQ(window_.oldestRecent()->id, 1);
  EXPECT_EQ(window_.after(*window_.oldestRecent())->id, 2);
  EXPECT_EQ(window_.after(window_.newest()), nullptr);
  for (const auto& frame : window_.frames()) frame->is_keyframe = frame->has_motion = false;
  EXPECT_EQ(window_.newestKeyframe(), nullptr);
  EXPECT_EQ(window_.oldestRecent(), nullptr);
}

TEST_F(WindowTest, ForgetsAFrameWithItsObservations) {
  const Frame* kept = window_.find(2);
  window_.remove(1);
  EXPECT_EQ(window_.find(2), kept) << "pointers to other frames stay valid";
  EXPECT_EQ(window_.tracks().count(11), 0u) << "nothing is left of this track";
  const FeatureTrack& track = window_.tracks().at(10);
  EXPECT_EQ(track.observations.size(), 4u);
  EXPECT_FALSE(track.seenIn(1));
  EXPECT_TRUE(track.seenIn(2));
}

TEST_F(WindowTest, TakesAnInterpolatedFrameAlongWithItsKeyframes) {
  Frame &before = *window_.find(0), &frame = *window_.find(1), &after = *window_.find(2);
  poseToBlock(Rigid3(Quat::Identity(), Vec3(0.0, 0.1, 0.0)), frame.pose.data());
  window_.interpolate(frame, before, after);
  EXPECT_EQ(window_.poseOnlyCount(), 1);
  EXPECT_EQ(window_.recentCount(), 3);
  EXPECT_LT((frame.worldFromBody().translation - Vec3(0.0, 0.1, 0.0)).norm(), 1e-15);
  // Time stamps are evenly spaced, so it lies halfway.
  before.first_pose = before.pose;
  poseToBlock(Rigid3(Quat::Identity(), Vec3(1.0, 0.0, 0.0)), after.pose.data());
  poseToBlock(Rigid3(Quat::Identity(), Vec3(0.0, 0.0, 0.4)), before.pose.data());
  window_.placeInterpolated();
  EXPECT_LT((frame.worldFromBody().translation - Vec3(0.5, 0.1, 0.2)).norm(), 1e-15);
  ASSERT_TRUE(frame.first_pose.has_value());
  EXPECT_LT((frame.firstWorldFromBody().translation - Vec3(0.5, 0.1, 0.0)).norm(), 1e-15);
}

TEST_F(WindowTest, ForgetsAKeyframeWithWhatHangsOnIt) {
  window_.interpolate(*window_.find(1), *window_.find(0), *window_.find(2));
  window_.remove(0);
  EXPECT_EQ(window_.find(1), nullptr);
  EXPECT_EQ(window_.frames().size(), 3u);
  EXPECT_EQ(window_.tracks().at(10).observations.size(), 3u);
}

TEST_F(WindowTest, FindsObservationsByFrameAndCamera) {
  const FeatureTrack& track = window_.tracks().at(11);
  ASSERT_NE(track.find(1, 1), nullptr);
  EXPECT_EQ(track.find(1, 1)->camera, 1);
  EXPECT_EQ(track.find(1, 0)->camera, 0);
  EXPECT_EQ(track.find(2, 0), nullptr);
}

}  // namespace
}  // namespace lodeline
