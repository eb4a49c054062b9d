#include "simulation/rendering/light/halocline.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lodeline {
namespace {

Halocline layer() {
  Halocline halocline;
  halocline.height_W = -2.0;
  halocline.thickness_m = 0.2;
  return halocline;
}

TEST(Halocline, SaltRisesOverItsThickness) {
  EXPECT_EQ(layer().saltShare(-1.8), 0.0);
  EXPECT_NEAR(layer().saltShare(-2.0), 0.5, 1e-12);
  EXPECT_NEAR(layer().saltShare(-2.05), 0.75, 1e-12);
  EXPECT_EQ(layer().saltShare(-2.2), 1.0);
}

TEST(Halocline, PathsWithinTheLayerHaveTheirLength) {
  EXPECT_NEAR(layer().pathWithin(-1.0, -3.0, 4.0), 0.4, 1e-12);  // through it, at a slope of 30 degrees
  EXPECT_NEAR(layer().pathWithin(-2.0, -3.0, 1.0), 0.1, 1e-12);
  EXPECT_NEAR(layer().pathWithin(-2.0, -2.0, 3.0), 3.0, 1e-12);
  EXPECT_EQ(layer().pathWithin(-1.0, -1.5, 3.0), 0.0);
}

TEST(Halocline, BlursWhatIsSeenThroughItAndNothingElse) {
  cv::Mat image(100, 640, CV_32F, cv::Scalar(0)), heights(100, 640, CV_32F, cv::Scalar(-1.0));
  cv::Mat range(100, 640, CV_32F, cv::Scalar(2.0));
  image.at<float>(50, 100) = image.at<float>(50, 500) = 1.0f;
  heights.colRange(320, 640).setTo(-3.0);
  blurByHalocline(image, range, heights, -1.0, layer());
  EXPECT_EQ(image.at<float>(50, 100), 1.0f);
  EXPECT_LT(image.at<float>(50, 500), 0.5f);
  EXPECT_NEAR(cv::sum(image.colRange(320, 640))[0], 1.0, 1e-3);
}

}  // namespace
}  // namespace lodeline
