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
  DepthOptions options_;
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
  // dz = z^2 / (f b) sigma = 30 cm a pixel, and no match is better than 0.06 px.
  options_.max_sigma_m = 0.12;
  const DepthImage kept = depths(first, second);
  EXPECT_GT(kept.share(), 0.5);
  EXPECT_NEAR(kept.sigma_m(200, 120), 0.02, 0.005);
  options_.max_sigma_m = 0.015;
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

class SweepDepthTest : public testing::Test {
 protected:
  SweepFrame frameAt(double x_m, double depth_m) const {
    return {Rigid3(Quat::Identity(), Vec3(x_m, 0.0, 0.0)),
            view_.rectify(0, test::planeImage(texture_, x_m, depth_m))};
  }
  cv::Mat texture_ = test::wallTexture();
  RectifiedView view_{test::wallCameras(1), {}};
  DepthOptions options_;
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
