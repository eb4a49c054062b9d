#include "lodeline/frontend/tracking/patch.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <functional>
#include <limits>

namespace lodeline {
namespace {

/// An image with texture in all directions whose value is also known between the pixels.
double texture(double x, double y) {
  return 110.0 + 22.0 * std::sin(0.31 * x + 0.4) * std::cos(0.27 * y) + 18.0 * std::sin(0.17 * x - 0.23 * y) +
         14.0 * std::cos(0.45 * y + 0.12 * x);
}

cv::Mat render(const std::function<double(double, double)>& value, int width = 160, int height = 120) {
  cv::Mat image(height, width, CV_8U);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(value(x, y));
  }
  return image;
}

const Eigen::Vector2f kCentre(80.0F, 60.0F);

PatchTemplate templateOf(const ImagePyramid& image) {
  auto result = PatchTemplate::extract(image, kCentre, image.levels());
  EXPECT_TRUE(result);
  return *result;
}

TEST(PatchTemplate, FindsASubPixelShift) {
  const PatchTemplate patch = templateOf(ImagePyramid(render(texture), 3));
  for (const Eigen::Vector2f& shift : {Eigen::Vector2f(0.37F, -0.81F), Eigen::Vector2f(5.3F, 3.9F)}) {
    const ImagePyramid moved(
        render([&](double x, double y) { return texture(x - shift.x(), y - shift.y()); }), 3);
    for (const PatchMotion motion : {PatchMotion::Shift, PatchMotion::Deformation}) {
      PatchWarp warp{kCentre, Eigen::Matrix2f::Identity()};
      const auto match = patch.align(moved, 2, motion, warp);
      ASSERT_TRUE(match);
      EXPECT_GT(match->correlation, 0.995F);
      EXPECT_LT((warp.position - kCentre - shift).norm(), 0.03F) << shift.transpose();
    }
  }
}

TEST(PatchTemplate, IsOnlyShiftedWhereThatIsAllItWasMadeFor) {
  const ImagePyramid image(render(texture), 2);
  const ImagePyramid moved(render([](double x, double y) { return texture(x - 0.6, y + 0.9); }), 2);
  const auto shifted = PatchTemplate::extract(image, kCentre, 2, PatchMotion::Shift);
  ASSERT_TRUE(shifted);
  PatchWarp expected{kCentre, Eigen::Matrix2f::Identity()}, warp = expected;
  ASSERT_TRUE(templateOf(image).align(moved, 1, PatchMotion::Shift, expected));
  ASSERT_TRUE(shifted->align(moved, 1, PatchMotion::Deformation, warp));
  EXPECT_EQ(warp.position, expected.position);
  EXPECT_EQ(warp.linear, expected.linear);
}

TEST(PatchTemplate, IsBlindToGainOffsetAndSlopeOfLight) {
  const PatchTemplate patch = templateOf(ImagePyramid(render(texture), 1));
  const ImagePyramid relit(render([](double x, double y) {
                             return 0.6 * texture(x - 0.5, y + 0.25) - 20.0 + 0.5 * (x - 80.0) -
                                    0.4 * (y - 60.0);
                           }),
                           1);
  PatchWarp warp{kCentre, Eigen::Matrix2f::Identity()};
  const auto match = patch.align(relit, 0, PatchMotion::Shift, warp);
  ASSERT_TRUE(match);
  EXPECT_GT(match->correlation, 0.995F);
  EXPECT_LT((warp.position - kCentre - Eigen::Vector2f(0.5F, -0.25F)).norm(), 0.03F);
}

/// Detail within the patch, which makes its deformation observable.
double fineTexture(double x, double y) {
  return texture(x, y) + 25.0 * std::sin(0.8 * x + 0.2 * y) * std::cos(0.7 * y - 0.3 * x);
}

TEST(PatchTemplate, FollowsRotationAndScale) {
  const PatchTemplate patch = templateOf(ImagePyramid(render(fineTexture), 1));
  Eigen::Matrix2d linear;
  linear << 1.08, -0.12, 0.10, 1.05;
  const Eigen::Vector2d centre = kCentre.cast<double>();
  const ImagePyramid warped(render([&](double x, double y) {
                              const Eigen::Vector2d source =
                                  centre + linear.inverse() * (Eigen::Vector2d(x, y) - centre);
                              return fineTexture(source.x(), source.y());
                            }),
                            1);
  PatchWarp warp{kCentre + Eigen::Vector2f(0.8F, -0.5F), Eigen::Matrix2f::Identity()};
  ASSERT_TRUE(patch.align(warped, 0, PatchMotion::Deformation, warp));
  EXPECT_LT((warp.position - kCentre).norm(), 0.1F);
  // The linear part is damped and converges over several images.
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(patch.align(warped, 0, PatchMotion::Deformation, warp));
  const auto match = patch.align(warped, 0, PatchMotion::Deformation, warp);
  ASSERT_TRUE(match);
  EXPECT_GT(match->correlation, 0.995F);
  EXPECT_LT((warp.position - kCentre).norm(), 0.05F);
  EXPECT_LT((warp.linear.cast<double>() - linear).norm(), 0.03);
}

TEST(PatchTemplate, GivesNothingWithoutTextureOnEdgesAndOutside) {
  const ImagePyramid flat(render([](double, double) { return 90.0; }), 1);
  EXPECT_FALSE(PatchTemplate::extract(flat, kCentre, 1));
  const ImagePyramid edge(render([](double x, double) { return 100.0 + 60.0 * std::tanh(0.5 * (x - 80.0)); }),
                          1);
  EXPECT_FALSE(PatchTemplate::extract(edge, kCentre, 1));
  const ImagePyramid good(render(texture), 1);
  EXPECT_FALSE(PatchTemplate::extract(good, Eigen::Vector2f(3.0F, 60.0F), 1));
  EXPECT_FALSE(PatchTemplate::extract(good, Eigen::Vector2f(80.0F, 118.0F), 1));
}

TEST(PatchTemplate, GivesNothingForStartsOutsideOrNowhere) {
  const ImagePyramid image(render(texture), 3);
  const PatchTemplate patch = templateOf(image);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Eigen::Vector2f& start :
       {Eigen::Vector2f(-50.0F, 60.0F), Eigen::Vector2f(1e9F, 0.0F), Eigen::Vector2f(nan, nan)}) {
    PatchWarp warp{start, Eigen::Matrix2f::Identity()};
    EXPECT_FALSE(patch.align(image, 2, PatchMotion::Deformation, warp));
    EXPECT_FALSE(patch.correlate(image, 0, {start, Eigen::Matrix2f::Identity()}));
  }
}

TEST(PatchTemplate, FitsExactlyAtTheBorderOfTheImage) {
  const ImagePyramid image(render(texture, 40, 40), 1);
  int fits = 0;
  for (float x = 0.0F; x < 40.0F; x += 0.25F) fits += PatchTemplate::extract(image, {x, 20.0F}, 1) ? 1 : 0;
  EXPECT_GT(fits, 80);
  EXPECT_LT(fits, 100);
}

}  // namespace
}  // namespace lodeline
