#include "lodeline/io/images/grey_png.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <vector>

#include "lodeline/io/images/png_filters.h"

namespace lodeline {
namespace {

/// Smooth shading with noise, for which encoders choose every filter.
cv::Mat greyPicture(int width_px, int height_px) {
  cv::Mat image(height_px, width_px, CV_8UC1);
  uint32_t state = 1;
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      state = state * 1664525u + 1013904223u;
      const int noise = static_cast<int>(state >> 28);
      image.at<uint8_t>(y, x) = static_cast<uint8_t>((3 * x + 5 * y + (x * y) / 64 + noise) & 255);
    }
  }
  return image;
}

std::vector<uint8_t> encode(const cv::Mat& image, const std::vector<int>& parameters = {}) {
  std::vector<uint8_t> bytes;
  cv::imencode(".png", image, bytes, parameters);
  return bytes;
}

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && std::equal(a.datastart, a.dataend, b.datastart);
}

TEST(GreyPng, PaethFollowsTheDefinition) {
  const auto by_definition = [](int a, int b, int c) {
    const int p = a + b - c;
    const int pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
    return pa <= pb && pa <= pc ? a : (pb <= pc ? b : c);
  };
  int differences = 0;
  for (int a = 0; a < 256; ++a) {
    for (int b = 0; b < 256; ++b) {
      for (int c = 0; c < 256; ++c) differences += png::paeth(a, b, c) == by_definition(a, b, c) ? 0 : 1;
    }
  }
  EXPECT_EQ(differences, 0);
}

TEST(GreyPng, UndoesEachFilterByHand) {
  // Rows: none 10 20; sub 5 +1; up +1 +1; average +2 +2; paeth +0 +0.
  const std::vector<uint8_t> filtered = {0, 10, 20, 1, 5, 1, 2, 1, 1, 3, 2, 2, 4, 0, 0};
  std::vector<uint8_t> pixels(10);
  ASSERT_TRUE(png::unfilter(filtered.data(), 2, 5, pixels.data()));
  EXPECT_EQ(pixels, (std::vector<uint8_t>{10, 20, 5, 6, 6, 7, 5, 8, 5, 8}));
  const std::vector<uint8_t> unknown = {5, 0, 0};
  EXPECT_FALSE(png::unfilter(unknown.data(), 2, 1, pixels.data()));
}

/// Reference implementation of the filters for rows of a filter type and `width` bytes each.
std::vector<uint8_t> unfilteredByDefinition(const std::vector<uint8_t>& filtered, int width) {
  const int height = static_cast<int>(filtered.size()) / (width + 1);
  std::vector<uint8_t> pixels(static_cast<size_t>(width * height));
  const auto at = [&](int x, int y) -> int {
    return x < 0 || y < 0 ? 0 : pixels[static_cast<size_t>(y * width + x)];
  };
  for (int y = 0; y < height; ++y) {
    const uint8_t* row = filtered.data() + y * (width + 1);
    for (int x = 0; x < width; ++x) {
      const int a = at(x - 1, y), b = at(x, y - 1), c = at(x - 1, y - 1);
      const int predicted[] = {0, a, b, (a + b) / 2, png::paeth(a, b, c)};
      pixels[static_cast<size_t>(y * width + x)] = static_cast<uint8_t>(row[x + 1] + predicted[row[0]]);
    }
  }
  return pixels;
}

// Mostly Paeth or Average, as adaptive encoders choose for photographs; all heights and mixtures of filters.
TEST(GreyPng, UndoesFiltersRowByRowAndAbreastAlike) {
  std::mt19937 random(1);
  for (const int width : {1, 13, 16, 45}) {
    for (int height = 1; height < 40; ++height) {
      std::vector<uint8_t> filtered(static_cast<size_t>((width + 1) * height));
      for (uint8_t& byte : filtered) byte = static_cast<uint8_t>(random());
      const auto kinds = static_cast<uint8_t>(height % 2 == 0 ? 5 : 4);  // with Paeth or without it
      for (int y = 0; y < height; ++y) {
        filtered[static_cast<size_t>(y * (width + 1))] =
            static_cast<uint8_t>(random() % 3 > 0 ? kinds - 1 : random() % kinds);
      }
      std::vector<uint8_t> pixels(static_cast<size_t>(width * height));
      ASSERT_TRUE(png::unfilter(filtered.data(), width, height, pixels.data()));
      EXPECT_EQ(pixels, unfilteredByDefinition(filtered, width)) << width << " x " << height;
    }
  }
}

TEST(GreyPng, GivesBackWhatWasEncoded) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 7), cv::Size(752, 480), cv::Size(33, 20)}) {
    const cv::Mat image = greyPicture(size.width, size.height);
    for (const int strategy : {cv::IMWRITE_PNG_STRATEGY_DEFAULT, cv::IMWRITE_PNG_STRATEGY_FILTERED,
                               cv::IMWRITE_PNG_STRATEGY_RLE}) {
      const std::vector<uint8_t> bytes = encode(image, {cv::IMWRITE_PNG_STRATEGY, strategy});
      EXPECT_TRUE(equal(decodeGreyPng(bytes), image)) << size << " strategy " << strategy;
    }
    EXPECT_TRUE(equal(decodeGreyPng(encode(image, {cv::IMWRITE_PNG_COMPRESSION, 9})), image));
  }
}

TEST(GreyPng, LeavesOtherKindsToOthers) {
  cv::Mat colour(4, 4, CV_8UC3, cv::Scalar(1, 2, 3));
  cv::Mat deep(4, 4, CV_16UC1, cv::Scalar(1000));
  EXPECT_TRUE(decodeGreyPng(encode(colour)).empty());
  EXPECT_TRUE(decodeGreyPng(encode(deep)).empty());
  EXPECT_TRUE(decodeGreyPng({}).empty());
}

TEST(GreyPng, RefusesDamageWhereverItIs) {
  const std::vector<uint8_t> good = encode(greyPicture(24, 16));
  for (size_t i = 0; i < good.size(); ++i) {
    std::vector<uint8_t> damaged = good;
    damaged[i] ^= 0x40;
    EXPECT_TRUE(decodeGreyPng(damaged).empty()) << "byte " << i;
    EXPECT_TRUE(decodeGreyPng(std::span(good).first(i)).empty()) << "cut at " << i;
  }
}

}  // namespace
}  // namespace lodeline
