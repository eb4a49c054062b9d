#include "lodeline/frontend/detection/image_quality.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "lodeline/frontend/test_sequence.h"

namespace lodeline {
namespace {

ImageQuality assessImage(const cv::Mat& image) { return assess(ImagePyramid(image, 4)); }

TEST(ImageQuality, NamesWhatHindersTracking) {
  const cv::Mat good = TestSequence(TestLight::daylight()).images(0).front();
  const ImageQuality quality = assessImage(good);
  EXPECT_EQ(quality.word, "good");
  EXPECT_NEAR(quality.mean_grey, cv::mean(good)[0], 0.5);
  EXPECT_GT(quality.contrast_grey, 20.0);

  EXPECT_EQ(assessImage(good * 0.05).word, "dark");
  EXPECT_EQ(assessImage(good * 3.0).word, "overexposed");
  EXPECT_EQ(assessImage(cv::Mat(480, 752, CV_8U, cv::Scalar(90))).word, "textureless");
  cv::Mat blurred;
  cv::blur(good, blurred, {15, 1});
  cv::blur(blurred, blurred, {1, 15});
  EXPECT_EQ(assessImage(blurred).word, "blurred");
  EXPECT_EQ(assessImage(TestSequence(TestLight::dimLamp()).images(0).front()).word, "faint");
}

TEST(ImageQuality, TextureIsBlindToThePoolOfLight) {
  cv::Mat pool(480, 752, CV_8U);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 752; ++x) {
      pool.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(200.0 * std::exp(-(x - 376) * (x - 376) / 6e4));
    }
  }
  EXPECT_LT(assessImage(pool).texture_grey, 0.3);
  EXPECT_GT(assessImage(pool).contrast_grey, 20.0);
}

}  // namespace
}  // namespace lodeline
