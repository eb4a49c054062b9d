#include "lodeline/io/images/grey_range.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace lodeline {
namespace {

/// All values from `low` to `high`, row by row.
cv::Mat ramp(int low, int high) {
  cv::Mat image(100, 100, CV_16UC1);
  for (int i = 0; i < 10'000; ++i) {
    image.at<uint16_t>(i / 100, i % 100) = static_cast<uint16_t>(low + (high - low) * i / 9'999);
  }
  return image;
}

GreyRange rangeOf(const cv::Mat& image) { return measureGreyRange(std::vector<cv::Mat>{image}).value(); }

TEST(GreyRange, FindsTheBitsInUse) {
  EXPECT_EQ(rangeOf(ramp(0, 65535)).shift, 8);
  EXPECT_EQ(rangeOf(ramp(0, 1023)).shift, 2);
  EXPECT_EQ(rangeOf(ramp(0, 4095)).shift, 4);
  EXPECT_EQ(rangeOf(ramp(0, 16383)).shift, 6);
  EXPECT_EQ(rangeOf(ramp(0, 255)).shift, 0);
  EXPECT_EQ(rangeOf(ramp(0, 700)).shift, 2) << "darker than a 10-bit camera can";
  EXPECT_EQ(rangeOf(ramp(0, 1023)).low, 0);
}

TEST(GreyRange, ValuesOfTenBitsBecomeTheirUpperEight) {
  const GreyRange range = rangeOf(ramp(0, 1023));
  for (int grey = 0; grey < 256; ++grey) EXPECT_EQ(range.grey(static_cast<uint16_t>(4 * grey)), grey);
  EXPECT_EQ(range.grey(60000), 255) << "no wrapping around";
}

TEST(GreyRange, DeadPixelsDoNotCount) {
  cv::Mat image = ramp(0, 1023);
  for (int i = 0; i < 5; ++i) image.at<uint16_t>(50, i) = 65535;
  EXPECT_EQ(rangeOf(image).shift, 2);
}

TEST(GreyRange, ThermalImagesUseASpanFarFromZero) {
  const GreyRange range = rangeOf(ramp(7000, 8000));
  EXPECT_GT(range.grey(8000) - range.grey(7000), 100);
  EXPECT_GT(range.grey(7000), 0);
  EXPECT_LT(range.grey(8000), 255);
}

TEST(GreyRange, IsDecidedOverTheRecording) {
  std::vector<size_t> looked_at;
  const auto brightening = [&](size_t i) {
    looked_at.push_back(i);
    return ramp(0, static_cast<int>(20 + 10 * i));
  };
  EXPECT_EQ(measureGreyRange(400, brightening).value().shift, 4);
  EXPECT_EQ(looked_at.size(), 8u);
  looked_at.clear();
  const auto of_8_bits = [&](size_t i) {
    looked_at.push_back(i);
    return cv::Mat(4, 4, CV_8UC1, cv::Scalar(9));
  };
  EXPECT_FALSE(measureGreyRange(400, of_8_bits));
  EXPECT_EQ(looked_at.size(), 1u);
}

}  // namespace
}  // namespace lodeline
