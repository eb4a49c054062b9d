#include "lodeline/frontend/detection/image_pyramid.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace lodeline {
namespace {

cv::Mat noise(int width, int height) {
  cv::Mat image(height, width, CV_8U);
  cv::RNG random(7);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

// Results must be bit-identical: the sums are of integers, and borders are mirrored at the outermost pixels.
TEST(ImagePyramid, IsSmoothedAsByAGaussian) {
  for (const auto& [width, height] :
       {std::pair(97, 51), {64, 48}, {4, 4}, {3, 5}, {2, 2}, {1, 40}, {40, 1}}) {
    const cv::Mat image = noise(width, height);
    for (const int side_px : {3, 5, 7}) {
      cv::Mat expected;
      const cv::Mat kernel = cv::getGaussianKernel(side_px, 0.0, CV_32F);
      cv::sepFilter2D(image, expected, CV_32F, kernel, kernel);
      const ImagePyramid pyramid(image, 1, side_px);
      ASSERT_EQ(pyramid.level(0).size(), image.size());
      EXPECT_EQ(cv::norm(pyramid.level(0), expected, cv::NORM_INF), 0.0)
          << width << " x " << height << " px, side " << side_px;
    }
  }
}

TEST(ImagePyramid, ReadsPartOfALargerImage) {
  const cv::Mat large = noise(120, 90), part = large(cv::Rect(10, 20, 50, 40));
  EXPECT_EQ(cv::norm(ImagePyramid(part, 1).level(0), ImagePyramid(part.clone(), 1).level(0), cv::NORM_INF),
            0.0);
}

TEST(ImagePyramid, HalvesUntilLevelsAreSmall) {
  const ImagePyramid pyramid(noise(200, 70), 5);
  ASSERT_EQ(pyramid.levels(), 3);
  EXPECT_EQ(pyramid.level(2).size(), cv::Size(50, 18));
}

}  // namespace
}  // namespace lodeline
