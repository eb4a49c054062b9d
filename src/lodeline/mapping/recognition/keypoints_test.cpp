#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "lodeline/frontend/test_sequence.h"
#include "lodeline/mapping/recognition/keypoints/blob_detector.h"
#include "lodeline/mapping/recognition/keypoints/scene_distance.h"
#include "lodeline/mapping/recognition/stereo_points.h"

namespace lodeline {
namespace {

FrameGeometry geometryOf(const Rig& rig) {
  FrameGeometry geometry;
  for (const CameraCalibration& camera : rig.cameras) {
    geometry.cameras.push_back(makeCamera(camera));
    geometry.body_from_cameras.push_back(camera.body_from_camera);
  }
  return geometry;
}

TEST(EvenedImage, DoesNotDependOnTheLightOfALamp) {
  const TestSequence sequence(TestLight::daylight());
  const auto camera = makeCamera(sequence.rig().cameras.front());
  const cv::Mat image = sequence.images(0).front();
  cv::Mat lit = image.clone();
  for (int y = 0; y < lit.rows; ++y) {
    for (int x = 0; x < lit.cols; ++x)
      lit.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(lit.at<uint8_t>(y, x) * (0.4 + 0.6 * x / lit.cols));
  }
  const EvenedImage even(image, *camera), lit_even(lit, *camera);
  const double before = cv::norm(image, lit, cv::NORM_L1) / static_cast<double>(image.total());
  const double after =
      cv::norm(even.grey, lit_even.grey, cv::NORM_L1) / static_cast<double>(even.grey.total());
  EXPECT_GT(before, 15.0);
  EXPECT_LT(after, 4.0);
  const Vec2 pixel(123.0, 45.0);
  EXPECT_LT((even.toRecorded(even.fromRecorded(pixel)) - pixel).norm(), 1e-9);
  EXPECT_LE(even.scale, 1.0);
}

TEST(DetectBlobs, FindsTheSamePointsUnderAnotherLight) {
  TestLight lamp = TestLight::daylight();
  lamp.ambient_grey = 20.0;
  lamp.lamp_grey = 90.0;
  const TestSequence day(TestLight::daylight()), night(lamp);
  const auto camera = makeCamera(day.rig().cameras.front());
  const auto first = detectBlobs(EvenedImage(day.images(0).front(), *camera), {}, 200);
  const auto second = detectBlobs(EvenedImage(night.images(0).front(), *camera), {}, 200);
  ASSERT_GT(first.size(), 100u);
  EXPECT_LE(first.size(), 200u);
  int again = 0;
  for (const Vec2& a : first) {
    again += std::any_of(second.begin(), second.end(), [&](const Vec2& b) { return (a - b).norm() < 1.5; });
  }
  EXPECT_GT(again, static_cast<int>(first.size()) / 2);
}

TEST(SceneDistance, KnowsSurfacesAndNotTheirEdges) {
  constexpr double kFocal_px = 300.0;
  std::vector<MapFeature> tracked;
  for (int i = 0; i < 100; ++i) {
    MapFeature& feature = tracked.emplace_back();
    feature.rays.emplace_back().pixel = Vec2(20.0 * (i % 10), 20.0 * (i / 10));
    feature.point_B = Vec3(0.0, 0.0, i % 10 < 5 ? 2.0 : 5.0);
  }
  const SceneDistance scene(tracked, kFocal_px);
  const ExpectedDistance on_surface = scene.at(Vec2(30.0, 90.0));
  EXPECT_NEAR(on_surface.distance_m, 2.0, 1e-9);
  ASSERT_TRUE(on_surface.relative_sigma);
  EXPECT_NEAR(*on_surface.relative_sigma, 0.05, 1e-6);
  EXPECT_FALSE(scene.at(Vec2(90.0, 90.0)).relative_sigma) << "between two surfaces";
  EXPECT_FALSE(scene.at(Vec2(400.0, 90.0)).relative_sigma) << "beside all points";
  EXPECT_FALSE(SceneDistance({}, kFocal_px).at(Vec2(0.0, 0.0)).relative_sigma);
}

TEST(RaysOfFurtherCamera, CrossOnTheWall) {
  constexpr double kSigma_px = 0.6;
  const TestSequence sequence(TestLight::daylight());
  const FrameGeometry geometry = geometryOf(sequence.rig());
  const std::vector<cv::Mat> images = sequence.images(0);
  std::vector<ExpectedPoint> expected;
  for (const Vec2& pixel : detectBlobs(EvenedImage(images[0], *geometry.cameras[0]), {}, 100)) {
    // The wall is flat, 2 m away, and the body looks at it.
    if (const auto ray = geometry.rayOf(0, pixel, kSigma_px)) expected.push_back({*ray, 2.3});
  }
  const auto rays = raysOfFurtherCamera(images[0], images[1], 1, geometry, expected, kSigma_px);
  ASSERT_EQ(rays.size(), expected.size());
  int points = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    if (!rays[i]) continue;
    const auto point = pointOfRays(-1, {expected[i].ray, *rays[i]});
    if (!point) continue;
    ++points;
    EXPECT_NEAR(point->point_B.z(), 2.0, 5.0 * point->distance_sigma_m);
  }
  EXPECT_GT(points, 50);
}

}  // namespace
}  // namespace lodeline
