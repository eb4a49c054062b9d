#include "lodeline/problem/marginalization/keyframe_policy.h"

#include <gtest/gtest.h>

#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

class KeyframePolicyTest : public testing::Test {
 protected:
  // A wall 4 m in front of the first frame, which is a keyframe.
  KeyframePolicyTest() : first_(test_.add(Rigid3(), true)) {
    for (int i = 0; i < 60; ++i) wall_.emplace_back(4.0, 0.25 * (i % 10) - 1.1, 0.25 * (i / 10) - 0.6);
    see(first_, 0, 60);
    for (int i = 0; i < 60; ++i) test_.place(i, wall_[i], first_);
  }

  // Observes the tracks begin..end-1 with half a pixel of noise.
  void see(const Frame& frame, int begin, int end) {
    for (int i = begin; i < end; ++i)
      test_.see(i, wall_[i], frame, 0, 0.5 * Vec2(random_.normal(), random_.normal()));
  }
  // Observes the same points with new tracks.
  void seeFresh(const Frame& frame, int count) {
    for (int i = 0; i < count; ++i) test_.see(1000 + i, wall_[i], frame);
  }
  bool wanted() const { return wantsKeyframe(test_.window, test_.factors, options_); }

  Random random_{1, "keyframe"};
  TestWindow test_{1};
  KeyframeOptions options_;
  std::vector<Vec3> wall_;
  Frame& first_;
};

TEST_F(KeyframePolicyTest, TheFirstFrameIsAKeyframe) {
  first_.is_keyframe = false;
  EXPECT_TRUE(wanted());
}

TEST_F(KeyframePolicyTest, StandingStillMakesNone) {
  for (int i = 0; i < 200; ++i) {
    see(test_.add(Rigid3(), false), 0, 60);
    EXPECT_FALSE(wanted()) << "frame " << i;
  }
}

TEST_F(KeyframePolicyTest, TurningAloneMakesNone) {
  see(test_.add(Rigid3(so3::exp(Vec3(0.0, 0.05, 0.1)), Vec3::Zero()), false), 0, 60);
  EXPECT_FALSE(wanted());
}

TEST_F(KeyframePolicyTest, MovingFarEnoughMakesOne) {
  // The points in front shift by about step / 4 m.
  const auto seeFrom = [&](double share_of_parallax) {
    const double step_m = share_of_parallax * 4.0 * options_.min_parallax_rad;
    Frame& next = test_.add(Rigid3(Quat::Identity(), Vec3(0.0, step_m, 0.0)), false);
    next.time =
        first_.time + Duration::fromSeconds(static_cast<double>(next.id) * options_.min_interval_s + 0.01);
    see(next, 0, 60);
  };
  seeFrom(0.8);
  EXPECT_FALSE(wanted());
  seeFrom(1.2);
  EXPECT_TRUE(wanted());
}

TEST_F(KeyframePolicyTest, MovingFastMakesNoneSooner) {
  const Rigid3 far(Quat::Identity(), Vec3(0.0, 1.2 * 4.0 * options_.min_parallax_rad, 0.0));
  Frame& next = test_.add(far, false);
  see(next, 0, 60);
  next.time = first_.time + Duration::fromSeconds(0.9 * options_.min_interval_s);
  EXPECT_FALSE(wanted());
  next.time = first_.time + Duration::fromSeconds(1.1 * options_.min_interval_s);
  EXPECT_TRUE(wanted());
}

TEST_F(KeyframePolicyTest, LosingSightMakesOneOnlyWhereThereIsSomethingNew) {
  see(test_.add(Rigid3(), false), 0, 20);
  EXPECT_FALSE(wanted()) << "a keyframe without new tracks would know less than the last one";
  const Frame& next = test_.add(Rigid3(), false);
  see(next, 0, 20);
  seeFresh(next, 30);
  EXPECT_TRUE(wanted());
}

TEST_F(KeyframePolicyTest, ADarkImageMakesNone) {
  test_.add(Rigid3(Quat::Identity(), Vec3(0.0, 1.0, 0.0)), false);
  EXPECT_FALSE(wanted());
}

TEST_F(KeyframePolicyTest, TheLastFrameToSeeBecomesOneBeforeItLeaves) {
  constexpr int kRecent = 3, kLeast = 10;
  Frame& early = test_.add(Rigid3(), false);
  see(early, 0, 60);
  Frame& last_to_see = test_.add(Rigid3(), false);
  see(last_to_see, 0, kLeast);
  const auto isKept = [&] {
    keepLastView(test_.window, kRecent, kLeast);
    EXPECT_FALSE(early.is_keyframe);
    return last_to_see.is_keyframe;
  };
  see(test_.add(Rigid3(), false), 0, kLeast - 1);
  for (int later = 2; later <= kRecent; ++later) {
    EXPECT_FALSE(isKept()) << "images may return, while it is among the recent frames";
    test_.add(Rigid3(), false);
  }
  EXPECT_TRUE(isKept());
  EXPECT_FALSE(test_.window.newest().is_keyframe);
}

TEST_F(KeyframePolicyTest, FramesBeforeTheLastToSeeAreLeftAlone) {
  Frame& early = test_.add(Rigid3(), false);
  see(early, 0, 60);
  for (int i = 0; i < 5; ++i) see(test_.add(Rigid3(), false), 0, 60);
  keepLastView(test_.window, 3, 10);
  EXPECT_FALSE(early.is_keyframe);
}

TEST_F(KeyframePolicyTest, ParallaxIsTheAngleWithoutRotation) {
  const double step_m = 0.4;
  const Frame& moved = test_.add(Rigid3(so3::exp(Vec3(0.1, 0.05, 0.1)), Vec3(0.0, step_m, 0.0)), false);
  for (int i = 0; i < 60; ++i) test_.see(i, wall_[i], moved);
  const std::optional<double> parallax = medianParallax(test_.window, first_, moved, test_.factors);
  // The lever arm of the camera rotates with the body, which adds a little; points off the axis shift less.
  ASSERT_TRUE(parallax.has_value());
  EXPECT_NEAR(*parallax, step_m / 4.0, 0.15 * step_m / 4.0);
  EXPECT_FALSE(medianParallax(test_.window, first_, test_.add(Rigid3()), test_.factors).has_value());
}

class InterpolationPolicyTest : public KeyframePolicyTest {
 protected:
  // Keyframes at 0, 1 and 2 s; the frame in question sees the wall.
  InterpolationPolicyTest() : between_(add(0.5, false)), after_(add(1.0, true)), last_(add(2.0, true)) {
    see(between_, 0, 60);
  }
  Frame& add(double time_s, bool is_keyframe) {
    Frame& frame = test_.add(Rigid3(), is_keyframe);
    frame.time = first_.time + Duration::fromSeconds(time_s);
    return frame;
  }
  std::optional<KeyframesAbout> about(double spacing_s, double gap_s) const {
    return keyframesAbout(test_.window, between_,
                          {.interpolated_gap_s = gap_s, .interpolated_spacing_s = spacing_s});
  }

  Frame &between_, &after_, &last_;
};

TEST_F(InterpolationPolicyTest, TakesTheNearestKeyframesOnBothSides) {
  const auto found = about(0.4, 1.1);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->before, &first_);
  EXPECT_EQ(found->after, &after_);
}

TEST_F(InterpolationPolicyTest, WantsFramesThatAreNeitherTooCloseNorTooFar) {
  EXPECT_FALSE(about(0.6, 1.1).has_value()) << "close to a keyframe";
  EXPECT_FALSE(about(0.4, 0.9).has_value()) << "keyframes far from each other";
  after_.is_keyframe = false;
  EXPECT_FALSE(about(0.4, 1.1).has_value()) << "no keyframe after it but one that is too far away";
  EXPECT_TRUE(about(0.4, 2.1).has_value());
  last_.is_keyframe = false;
  EXPECT_FALSE(about(0.4, 2.1).has_value()) << "none at all";
}

TEST_F(InterpolationPolicyTest, WantsNoneThatSeesNoLandmark) {
  for (auto& [id, track] : test_.window.tracks()) track.landmark.reset();
  EXPECT_FALSE(about(0.4, 1.1).has_value());
}

}  // namespace
}  // namespace lodeline
