// Tests that the information of removed frames and landmarks stays in the prior, as far as the options ask
// for it.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lodeline/estimator/solver/window_update.h"
#include "lodeline/estimator/trials/marginalizer_dive.h"
#include "lodeline/problem/covariance.h"

namespace lodeline {
namespace {

/// Sigma of the newest frame's yaw after the given number of frames, every nth of them a keyframe.
double yawSigmaAfter(int frames, int keyframe_every, const WindowOptions& wanted, TestWindow& test) {
  Marginalizer marginalizer(test.factors);
  TestScene scene(sceneOptions(0.1 * frames + 1.0, 10.0));
  for (int k = 0; k < frames; ++k) {
    addNext(test, scene, keyframe_every, &marginalizer);
    updateWindow(test.window, marginalizer.prior(), test.factors, {4, 1e-6});
    marginalizer.marginalizeToSize(test.window, wanted);
  }
  return std::sqrt(newestCovariance(test.window, marginalizer.prior(), test.factors)(5, 5));
}

// The information from observations of an interpolated frame about its neighbouring keyframes stays in the
// prior.
TEST(Marginalizer, CarriesOnWhatInterpolatedFramesSaw) {
  const auto yawSigma = [](double spacing_s) {
    TestWindow test(2, quadraticOptions());
    const double sigma =
        yawSigmaAfter(60, 3, {.recent_frames = 5, .keyframes = 4, .interpolated_spacing_s = spacing_s}, test);
    EXPECT_EQ(test.window.frames().size() > 9u, spacing_s < 0.1);
    return sigma;
  };
  const double dropped = yawSigma(1.0), kept = yawSigma(0.05);
  // Three times the observations: 0.58 if there were no others.
  EXPECT_LT(kept, 0.85 * dropped);
  EXPECT_GT(kept, 0.5 * dropped);
}

// The same holds for a landmark that outlives the window, except for the correlation of both sides of a cut.
TEST(Marginalizer, CarriesOnWhatLandmarksThatLiveOnWereSeenBy) {
  const auto yawSigma = [](int split_at_keyframe) {
    TestWindow test(2, quadraticOptions());
    return yawSigmaAfter(80, 2, {.recent_frames = 5, .keyframes = 6, .split_at_keyframe = split_at_keyframe},
                         test);
  };
  const double dropped = yawSigma(6), kept = yawSigma(2);
  EXPECT_LT(kept, 0.9 * dropped);
  EXPECT_GT(kept, 0.2 * dropped);
}

// For any number of keyframes that leave at once.
TEST(Marginalizer, CutsNothingWhereNothingIsAskedToBeCut) {
  constexpr int kKeyframes = 6, kNever = std::numeric_limits<int>::max();
  const auto informationAfter = [](const auto& shorten) {
    TestWindow test(2, quadraticOptions());
    Marginalizer marginalizer(test.factors);
    TestScene scene(sceneOptions(9.0, 10.0));
    for (int k = 0; k < 60; ++k) addNext(test, scene, 2, &marginalizer);
    updateWindow(test.window, marginalizer.prior(), test.factors, {4, 1e-6});
    marginalizer.marginalizeToSize(test.window, {.recent_frames = 5, .keyframes = 60});
    EXPECT_GT(test.window.poseOnlyCount(), 3 * kKeyframes);
    shorten(marginalizer, test.window);
    return marginalizer.prior().sqrt_information;
  };
  const auto atOnce = [&](int split_at_keyframe) {
    return informationAfter([&](Marginalizer& marginalizer, Window& window) {
      marginalizer.marginalizeToSize(
          window, {.recent_frames = 5, .keyframes = kKeyframes, .split_at_keyframe = split_at_keyframe});
    });
  };
  const auto one_by_one = informationAfter([](Marginalizer& marginalizer, Window& window) {
    for (int left = window.poseOnlyCount() - 1; left >= kKeyframes; --left) {
      marginalizer.marginalizeToSize(window,
                                     {.recent_frames = 5, .keyframes = left, .split_at_keyframe = left});
    }
  });
  EXPECT_EQ(atOnce(kNever), one_by_one);
  EXPECT_NE(atOnce(kKeyframes), one_by_one);
}

}  // namespace
}  // namespace lodeline
