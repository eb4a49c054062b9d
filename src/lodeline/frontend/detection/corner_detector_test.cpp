#include "lodeline/frontend/detection/corner_detector.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "lodeline/frontend/test_sequence.h"

namespace lodeline {
namespace {

const ImagePyramid& rock() {
  static const ImagePyramid kImage(TestSequence(TestLight::daylight()).images(0).front(), 2);
  return kImage;
}

std::vector<Eigen::Vector2f> detect(const ImagePyramid& image, const cv::Mat& mask = {},
                                    const std::vector<Eigen::Vector2f>& occupied = {}, bool noisy = false) {
  return CornerDetector({}).detect(image, mask, occupied, noisy);
}

TEST(CornerDetector, SpreadsCornersOverTheImage) {
  const std::vector<Eigen::Vector2f> corners = detect(rock());
  EXPECT_GE(corners.size(), 230u);
  int quadrants[4] = {0, 0, 0, 0};
  for (size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2f& c = corners[i];
    ++quadrants[(c.x() > 376.0F ? 1 : 0) + (c.y() > 240.0F ? 2 : 0)];
    EXPECT_TRUE(c.x() >= 12.0F && c.y() >= 12.0F && c.x() <= 740.0F && c.y() <= 468.0F);
    for (size_t j = 0; j < i; ++j) EXPECT_GE((c - corners[j]).norm(), 13.0F);
  }
  for (const int n : quadrants) EXPECT_GT(n, 40);
}

TEST(CornerDetector, FillsOnlyWhatIsEmptyAndNotMasked) {
  const std::vector<Eigen::Vector2f> all = detect(rock());
  EXPECT_LT(detect(rock(), {}, all).size(), 20u);

  std::vector<Eigen::Vector2f> left_half;
  for (const Eigen::Vector2f& corner : all) {
    if (corner.x() < 376.0F) left_half.push_back(corner);
  }
  const std::vector<Eigen::Vector2f> added = detect(rock(), {}, left_half);
  EXPECT_GT(added.size(), 90u);
  for (const Eigen::Vector2f& corner : added) {
    for (const Eigen::Vector2f& other : left_half) EXPECT_GE((corner - other).norm(), 13.0F);
  }

  cv::Mat mask(480, 752, CV_8U, cv::Scalar(255));
  mask(cv::Rect(0, 0, 752, 200)).setTo(0);
  const std::vector<Eigen::Vector2f> unmasked = detect(rock(), mask);
  EXPECT_GT(unmasked.size(), 100u);
  for (const Eigen::Vector2f& corner : unmasked) EXPECT_GE(corner.y(), 200.0F);
}

TEST(CornerDetector, FindsNothingOnABareWallOrInATinyImage) {
  EXPECT_TRUE(detect(ImagePyramid(cv::Mat(480, 752, CV_8U, cv::Scalar(80)), 2)).empty());
  EXPECT_TRUE(detect(ImagePyramid(cv::Mat(10, 12, CV_8U, cv::Scalar(80)), 2)).empty());
}

/// A plain image with a brightness gradient, as in silted water.
cv::Mat siltedWater(double noise_grey) {
  cv::Mat light(480, 752, CV_32F), noise(480, 752, CV_32F), picture;
  for (int y = 0; y < light.rows; ++y) light.row(y).setTo(70.0 + 0.1 * y);
  cv::RNG random(5);
  random.fill(noise, cv::RNG::NORMAL, 0.0, noise_grey);
  cv::Mat(light + noise).convertTo(picture, CV_8U);
  return picture;
}

TEST(CornerDetector, TakesNoNoiseForCorners) {
  for (const double noise_grey : {2.0, 4.0, 8.0}) {
    for (const int smoothing_px : {3, 7}) {
      EXPECT_LE(detect(ImagePyramid(siltedWater(noise_grey), 2, smoothing_px), {}, {}, true).size(), 2u)
          << noise_grey << smoothing_px;
    }
  }
}

TEST(CornerDetector, FindsRockInNoise) {
  TestLight light = TestLight::daylight();
  light.noise_grey = 8.0;
  EXPECT_GE(detect(ImagePyramid(TestSequence(light).images(0).front(), 2, 7), {}, {}, true).size(), 200u);
}

}  // namespace
}  // namespace lodeline
