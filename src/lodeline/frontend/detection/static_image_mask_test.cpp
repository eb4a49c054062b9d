#include "lodeline/frontend/detection/static_image_mask.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "lodeline/frontend/front_end.h"
#include "lodeline/frontend/test_sequence.h"

namespace lodeline {
namespace {

const cv::Rect kBar(0, 200, 320, 40);

cv::Mat texture(int seed, cv::Size size, double contrast_grey) {
  cv::RNG random(static_cast<uint64_t>(seed));
  cv::Mat noise(size, CV_32F), result;
  random.fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
  cv::GaussianBlur(noise, noise, {0, 0}, 3.0);
  cv::normalize(noise, noise, 0.0, 1.0, cv::NORM_MINMAX);
  cv::Mat(90.0 + contrast_grey * (noise - 0.5)).convertTo(result, CV_8U);
  return result;
}

/// A camera that observes a part of a wide image, with its own noise.
class StaticImageMaskTest : public testing::Test {
 protected:
  cv::Mat view(double x_px, double y_px) {
    cv::Mat image, noise(240, 320, CV_16S);
    world_(cv::Rect(static_cast<int>(x_px), static_cast<int>(y_px), 320, 240)).convertTo(image, CV_16S);
    random_.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
    image += noise;
    image.convertTo(image, CV_8U);
    return image;
  }
  void add(const cv::Mat& image) { fixed_.add(Time::fromSeconds(1.1 * number_++), ImagePyramid(image, 4)); }
  /// View along a path that never returns to a previous position.
  cv::Mat viewOnTheWay(int i) { return view(10.0 + 12.0 * i, 60.0 + 40.0 * std::sin(0.7 * i)); }
  static cv::Mat withBar(cv::Mat image) {
    static const cv::Mat kLooks = texture(7, kBar.size(), 120.0);
    kLooks.copyTo(image(kBar));
    return image;
  }

  cv::Mat world_ = texture(3, {1600, 400}, 200.0);
  cv::RNG random_{11};
  StaticImageMask fixed_{{}};
  int number_ = 0;
};

TEST_F(StaticImageMaskTest, IsFoundAndNothingElse) {
  for (int i = 0; i < 60; ++i) add(withBar(viewOnTheWay(i)));
  ASSERT_FALSE(fixed_.mask().empty());
  EXPECT_EQ(fixed_.mask().size(), cv::Size(320, 240));
  const double bar_found = 1.0 - cv::countNonZero(fixed_.mask()(kBar)) / static_cast<double>(kBar.area());
  EXPECT_GT(bar_found, 0.95);
  EXPECT_EQ(cv::countNonZero(fixed_.mask()(cv::Rect(0, 0, 320, 160)) == 0), 0);
  EXPECT_NEAR(fixed_.share(), kBar.area() / (320.0 * 240.0), 0.1);
}

TEST_F(StaticImageMaskTest, IsNoneWhereAllMoves) {
  for (int i = 0; i < 80; ++i) {
    add(viewOnTheWay(i));
    ASSERT_TRUE(fixed_.mask().empty()) << i;
  }
  EXPECT_GE(fixed_.looks(), 32);
}

TEST_F(StaticImageMaskTest, IsNoneWhileStandingStill) {
  for (int i = 0; i < 80; ++i) add(view(300.0, 80.0));
  EXPECT_EQ(fixed_.looks(), 1);
  EXPECT_TRUE(fixed_.mask().empty());
}

TEST_F(StaticImageMaskTest, IsNoneWhileSwayingAtOnePlace) {
  for (int i = 0; i < 200; ++i) {
    add(view(300.0 + 25.0 * std::sin(0.9 * i), 80.0 + 8.0 * std::cos(0.9 * i)));
    ASSERT_TRUE(fixed_.mask().empty()) << i;
  }
}

TEST_F(StaticImageMaskTest, IsForgottenOnceItIsGone) {
  for (int i = 0; i < 40; ++i) add(withBar(viewOnTheWay(i)));
  ASSERT_FALSE(fixed_.mask().empty());
  for (int i = 40; i < 160; ++i) add(viewOnTheWay(i % 100));
  EXPECT_TRUE(fixed_.mask().empty());
  EXPECT_EQ(fixed_.share(), 0.0);
}

TEST_F(StaticImageMaskTest, NeedsNoTextureAndNoImage) {
  fixed_.add(Time::fromSeconds(0.0), ImagePyramid());
  for (int i = 0; i < 40; ++i) add(cv::Mat(240, 320, CV_8U, cv::Scalar(30)));
  EXPECT_EQ(fixed_.looks(), 0);
  EXPECT_TRUE(fixed_.mask().empty());
}

TEST_F(StaticImageMaskTest, IsNotLookedForWhereSwitchedOff) {
  fixed_ = StaticImageMask({.enabled = false});
  for (int i = 0; i < 60; ++i) add(withBar(viewOnTheWay(i)));
  EXPECT_EQ(fixed_.looks(), 0);
}

TEST(FrontEndWithStaticImageMask, FollowsNothingThere) {
  const TestSequence sequence(TestLight::daylight(), 1.5);
  const cv::Rect bar(0, 380, 752, 100);
  const cv::Mat looks = texture(7, bar.size(), 120.0);
  FrontEnd front_end(sequence.rig(), {});
  constexpr int kFrames = 22;
  for (int i = 0; i < kFrames; ++i) {
    std::vector<cv::Mat> images = sequence.images(i);
    for (cv::Mat& image : images) looks.copyTo(image(bar));
    const Quat turn =
        i == 0
            ? Quat::Identity()
            : Quat(sequence.worldFromBody(i - 1).rotation.conjugate() * sequence.worldFromBody(i).rotation);
    front_end.process(Time::fromSeconds(100.0 + 0.3 * i), images, turn);
  }
  ASSERT_GT(front_end.fixedStructures().front().share(), 0.15);
  EXPECT_LT(front_end.fixedStructures().front().share(), 0.3);
  EXPECT_GT(front_end.statistics().tracks(), 100);
  const auto in_bar =
      std::count_if(front_end.tracks().begin(), front_end.tracks().end(),
                    [&](const Track& track) { return track.warp.position.y() > static_cast<float>(bar.y); });
  EXPECT_EQ(in_bar, 0);
}

}  // namespace
}  // namespace lodeline
