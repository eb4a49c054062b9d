#include "lodeline/frontend/detection/particle_filter.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "lodeline/frontend/detection/corner_detector.h"
#include "lodeline/frontend/test_sequence.h"

namespace lodeline {
namespace {

/// Dim background with a lamp's gradient and a sensor's noise.
cv::Mat milkyWater() {
  cv::Mat image(480, 640, CV_32F), noise(480, 640, CV_32F);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) image.at<float>(y, x) = 60.0F + 0.05F * x - 0.03F * y;
  }
  cv::theRNG().state = 7;
  cv::randn(noise, 0.0, 1.0);
  return image + noise;
}

cv::Mat toGrey(const cv::Mat& image) {
  cv::Mat grey;
  image.convertTo(grey, CV_8U);
  return grey;
}

/// Adds a bright dot as wide as the image of a point.
void addDot(cv::Mat& image, const cv::Point& at, float height, float radius_px) {
  for (int y = at.y - 9; y <= at.y + 9; ++y) {
    for (int x = at.x - 9; x <= at.x + 9; ++x) {
      const cv::Point d = cv::Point(x, y) - at;
      image.at<float>(y, x) +=
          height * std::exp(-0.5F * static_cast<float>(d.dot(d)) / (radius_px * radius_px));
    }
  }
}

bool particleAt(const cv::Mat& image, const cv::Point& at) {
  return isParticle(ImagePyramid(toGrey(image), 2).level(1), at / 2);
}

TEST(Particle, IsADotThatStandsAlone) {
  for (const float radius_px : {1.0F, 1.5F, 2.5F}) {
    cv::Mat image = milkyWater();
    addDot(image, {300, 200}, 60.0F, radius_px);
    EXPECT_TRUE(particleAt(image, {300, 200})) << radius_px;
    EXPECT_TRUE(particleAt(image, {304, 197})) << radius_px;
  }
}

TEST(Particle, IsNoCornerOfRockAndNoDarkDot) {
  cv::Mat image = milkyWater();
  cv::rectangle(image, {100, 100}, {200, 200}, 110.0, cv::FILLED);
  for (const cv::Point corner : {cv::Point(100, 100), cv::Point(200, 100), cv::Point(200, 200)}) {
    EXPECT_FALSE(particleAt(image, corner));
  }
  addDot(image, {300, 200}, -40.0F, 1.5F);
  EXPECT_FALSE(particleAt(image, {300, 200}));
  cv::line(image, {400, 50}, {400, 400}, 100.0, 3);
  EXPECT_FALSE(particleAt(image, {400, 200}));
}

TEST(Particle, IsRareOnTexturedRock) {
  const ImagePyramid rock(TestSequence(TestLight::daylight()).images(0).front(), 2);
  int particles = 0, points = 0;
  for (int y = 20; y < 220; y += 10) {
    for (int x = 20; x < 350; x += 10, ++points) particles += isParticle(rock.level(1), {x, y}) ? 1 : 0;
  }
  EXPECT_LT(particles, 0.03 * points);
}

TEST(Particle, IsNoPointToFollow) {
  cv::Mat image = milkyWater();
  for (int i = 0; i < 60; ++i) addDot(image, {30 + (i * 97) % 580, 30 + (i * 61) % 420}, 60.0F, 1.5F);
  EXPECT_TRUE(CornerDetector({}).detect(ImagePyramid(toGrey(image), 2), {}, {}).empty());
}

}  // namespace
}  // namespace lodeline
