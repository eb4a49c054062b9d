#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/output/walls/depth/depth_store.h"
#include "lodeline/output/walls/depth/refine_disparity.h"
#include "lodeline/output/walls/depth/stereo_depth.h"
#include "lodeline/output/walls/depth/sweep_depth.h"
#include "lodeline/output/walls/depth/test_wall_images.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

/// Share of all pixels with a depth, and share of these that are right to 2 %.
std::pair<double, double> quality(const DepthImage& image, double depth_m) {
  int known = 0, right = 0;
  for (int v = 0; v < image.depth.rows; ++v) {
    for (int u = 0; u < image.depth.cols; ++u) {
      if (image.depth_m(u, v) <= 0.0) continue;
      ++known;
      right += std::abs(image.depth_m(u, v) / depth_m - 1.0) < 0.02 ? 1 : 0;
    }
  }
  return {static_cast<double>(known) / static_cast<double>(image.depth.total()),
          static_cast<double>(right) / std::max(1, known)};
}

class StereoDepthTest : public testing::Test {
 protected:
  DepthImage depths(const cv::Mat& first, const cv::Mat& second) const {
    return StereoDepth(view_, options_).compute(view_.rectify(0, first), view_.rectify(1, second));
  }
  RectifiedView view_{test::wallCameras(2), {}};
  DepthImageOptions options_;
};

TEST_F(StereoDepthTest, MeasuresAPlane) {
  const cv::Mat texture = test::wallTexture();
  for (const double depth_m : {0.7, 1.5}) {
    const auto [known, right] = quality(depths(test::planeImage(texture, 0.0, depth_m),
                                               test::planeImage(texture, test::kWallBaseline_m, depth_m)),
                                        depth_m);
    EXPECT_GT(known, 0.6);
    EXPECT_GT(right, 0.97);
  }
}

TEST_F(StereoDepthTest, GivesNothingWithoutTexture) {
  const cv::Mat grey(240, 320, CV_8U, cv::Scalar(90));
  EXPECT_EQ(quality(depths(grey, grey), 1.0).first, 0.0);
}

TEST_F(StereoDepthTest, GivesAlmostNothingForUnrelatedImages) {
  const DepthImage image = depths(test::planeImage(test::wallTexture(1), 0.0, 1.0),
                                  test::planeImage(test::wallTexture(2), 0.0, 1.0));
  EXPECT_LT(image.share(), 0.03);
}

TEST_F(StereoDepthTest, LeavesOutWhatIsTooUncertain) {
  const cv::Mat texture = test::wallTexture();
  const cv::Mat first = test::planeImage(texture, 0.0, 3.0);
  const cv::Mat second = test::planeImage(texture, test::kWallBaseline_m, 3.0);
  // dz = z^2 / (f b) sigma = 30 cm a pixel, and no match is better than 0.12 px.
  options_.max_sigma_m = 0.12;
  const DepthImage kept = depths(first, second);
  EXPECT_GT(kept.share(), 0.5);
  EXPECT_NEAR(kept.sigma_m(200, 120), 0.038, 0.005);
  options_.max_sigma_m = 0.03;
  EXPECT_LT(depths(first, second).share(), 0.03);
}

TEST(RefineDisparity, FindsFractionsOfAPixel) {
  const cv::Mat texture = test::wallTexture();
  const double depth_m = 1.37, true_px = test::kWallFocal_px * test::kWallBaseline_m / depth_m;
  cv::Mat second = test::planeImage(texture, test::kWallBaseline_m, depth_m);
  second += 12;  // a brighter camera
  cv::Mat start(240, 320, CV_32F, cv::Scalar(std::round(true_px)));
  start.rowRange(0, 40).setTo(-1.0F);
  const Disparities refined = refineDisparity(test::planeImage(texture, 0.0, depth_m), second, start);
  for (int u = 60; u < 300; u += 20) {
    // warpAffine() places pixels to 1/32 px.
    EXPECT_NEAR(refined.value_px.at<float>(120, u), true_px, 0.08) << u;
    EXPECT_GT(refined.sigma_px.at<float>(120, u), 0.05F);
    EXPECT_EQ(refined.value_px.at<float>(20, u), -1.0F);
  }
}

/// RMS of the errors of refined disparities, and of their sigmas, from starts that are off by 0.3 px (RMS) in
/// each pixel alone; a faint wall in images with noise of `noise_grey`.
std::pair<double, double> refinedErrors(double noise_grey) {
  const double depth_m = 1.37, true_px = test::kWallFocal_px * test::kWallBaseline_m / depth_m;
  cv::RNG random(5);
  const auto imageAt = [&](double x_m) {
    cv::Mat image = test::planeImage(test::wallTexture(), x_m, depth_m), noise(240, 320, CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0.0, noise_grey);
    image.convertTo(image, CV_32F, 0.15, 60.0);
    image += noise;
    image.convertTo(image, CV_8U);
    return image;
  };
  cv::Mat start(240, 320, CV_32F);
  random.fill(start, cv::RNG::NORMAL, true_px, 0.3);
  const Disparities refined = refineDisparity(imageAt(0.0), imageAt(test::kWallBaseline_m), start);
  double errors = 0.0, sigmas = 0.0;
  int count = 0;
  for (int v = 20; v < 220; ++v) {
    for (int u = 60; u < 300; ++u) {
      if (refined.value_px.at<float>(v, u) < 0.0F) continue;
      errors += std::pow(refined.value_px.at<float>(v, u) - true_px, 2.0);
      sigmas += std::pow(refined.sigma_px.at<float>(v, u), 2.0);
      ++count;
    }
  }
  EXPECT_GT(count, 0.9 * 200 * 240);
  return {std::sqrt(errors / count), std::sqrt(sigmas / count)};
}

TEST(RefineDisparity, IsAsGoodAsItSaysInNoise) {
  for (const double noise_grey : {0.5, 2.0, 5.0}) {
    const auto [error_px, sigma_px] = refinedErrors(noise_grey);
    EXPECT_LT(error_px, 1.2 * sigma_px) << noise_grey;
    EXPECT_LT(sigma_px, 0.12 + 0.1 * noise_grey) << noise_grey;
  }
  EXPECT_LT(refinedErrors(0.5).first, 0.1);
  EXPECT_LT(refinedErrors(2.0).first, 0.2);
}

TEST(RefineDisparity, KeepsAnEdge) {
  constexpr int kEdge = 160;
  const cv::Mat first = test::planeImage(test::wallTexture(), 0.0, 1.0);
  cv::Mat second(first.size(), CV_8U, cv::Scalar(0)), start(first.size(), CV_32F, cv::Scalar(12.0));
  start.colRange(kEdge, 320).setTo(20.0F);
  first.colRange(12, kEdge).copyTo(second.colRange(0, kEdge - 12));
  first.colRange(kEdge, 320).copyTo(second.colRange(kEdge - 20, 300));
  const cv::Mat refined = refineDisparity(first, second, start).value_px;
  for (int u = 130; u < 180; ++u) {
    if (u >= kEdge - 12 && u < kEdge + 2) continue;  // hidden behind the right half, and the edge itself
    // The mean of a window over the edge is off by 2 px and more.
    EXPECT_NEAR(refined.at<float>(120, u), u < kEdge ? 12.0 : 20.0, 0.6) << u;
  }
}

class SweepDepthTest : public testing::Test {
 protected:
  SweepFrame frameAt(double x_m, double depth_m) const {
    return {Rigid3(Quat::Identity(), Vec3(x_m, 0.0, 0.0)),
            view_.rectify(0, test::planeImage(texture_, x_m, depth_m))};
  }
  cv::Mat texture_ = test::wallTexture();
  RectifiedView view_{test::wallCameras(1), {}};
  DepthImageOptions options_;
};

TEST_F(SweepDepthTest, MeasuresAPlane) {
  const DepthImage image =
      SweepDepth(view_, options_).compute(frameAt(0.0, 1.6), {frameAt(-0.2, 1.6)}, {frameAt(0.2, 1.6)});
  const auto [known, right] = quality(image, 1.6);
  EXPECT_GT(known, 0.6);
  EXPECT_GT(right, 0.95);
}

TEST_F(SweepDepthTest, NeedsAnotherPlace) {
  const SweepDepth sweep(view_, options_);
  EXPECT_EQ(sweep.compute(frameAt(0.0, 1.6), {}, {}).share(), 0.0);
  EXPECT_LT(sweep.compute(frameAt(0.0, 1.6), {frameAt(0.0, 1.6)}, {}).share(), 0.01);
}

TEST(DepthStore, KeepsEveryBit) {
  const test::TemporaryFolder folder;
  const DepthStore store(folder.path() / "work");
  DepthImage image(cv::Size(4, 3));
  image.set(2, 1, 1.2345, 0.017);
  image.colour = cv::Mat(3, 4, CV_8UC3, cv::Scalar(1, 2, 3));
  EXPECT_FALSE(store.has(7));
  store.write(7, image);
  ASSERT_TRUE(store.has(7));
  const DepthImage read = store.read(7);
  EXPECT_DOUBLE_EQ(read.depth_m(2, 1), 1.2345);
  EXPECT_DOUBLE_EQ(read.sigma_m(2, 1), 0.017);
  EXPECT_EQ(read.depth_m(0, 0), 0.0);
  EXPECT_EQ(read.colour.at<cv::Vec3b>(2, 3), cv::Vec3b(1, 2, 3));
}

TEST(DepthStore, RefusesDamage) {
  const test::TemporaryFolder folder;
  const DepthStore store(folder.path());
  writeOutput(folder.path() / "000001.depth", "short");
  EXPECT_THROW(store.read(1), InputError);
  EXPECT_THROW(store.read(2), InputError);
}

}  // namespace
}  // namespace lodeline
