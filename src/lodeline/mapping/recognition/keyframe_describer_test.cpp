#include "lodeline/mapping/recognition/keyframe_describer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "lodeline/diagnostics.h"
#include "lodeline/frontend/test_sequence.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/recognition/loop_verifier.h"
#include "lodeline/mapping/recognition/test_described_frames.h"
#include "lodeline/mapping/recognition/upright_descriptors.h"

namespace lodeline {
namespace {

/// The sequence's world has y down; the map's has z up.
Rigid3 upright(const Rigid3& world_from_body) {
  const Rigid3 up_from_world(Quat(Eigen::AngleAxisd(-std::numbers::pi / 2.0, Vec3::UnitX())), Vec3::Zero());
  return up_from_world * world_from_body;
}

MapKeyframe keyframeOfFrame(const TestSequence& sequence, int frame) {
  return keyframeOfImages(sequence.rig(), sequence.images(frame), upright(sequence.worldFromBody(frame)),
                          0.001);
}

TEST(KeyframeDescriber, DescribesTracksAndBlobs) {
  const TestSequence sequence(TestLight::daylight());
  const MapKeyframe keyframe = keyframeOfFrame(sequence, 0);
  int tracked = 0, blobs = 0, points = 0;
  for (const MapFeature& feature : keyframe.features) {
    tracked += feature.track >= 0 ? 1 : 0;
    blobs += feature.track < 0 ? 1 : 0;
    ASSERT_FALSE(feature.rays.empty());
    EXPECT_EQ(feature.rays.front().camera, 0);
    EXPECT_NEAR(feature.rays.front().bearing_B.norm(), 1.0, 1e-9);
    if (!feature.point_B) continue;
    ++points;
    // The wall is flat, 2 m away, and the body looks at it.
    EXPECT_NEAR(feature.point_B->z(), 2.0, 5.0 * feature.distance_sigma_m);
    EXPECT_GT(feature.distance_sigma_m, 0.0);
  }
  EXPECT_GT(tracked, 150);
  EXPECT_GT(blobs, 50);
  EXPECT_GT(points, 120);
  EXPECT_LE(keyframe.features.size(), 400u);
}

TEST(KeyframeDescriber, DepthsAreAsUncertainAsTheHeightAndTheDensity) {
  FrameEstimate estimate;
  estimate.covariance.setIdentity();
  estimate.covariance(2, 2) = 0.04;
  DepthEstimate::Gauge gauge;
  gauge.density_ratio = 1.025;
  gauge.density_ratio_sigma = 0.01025;
  gauge.body_depth_m = 20.0;
  estimate.sensors.of<DepthEstimate>().gauge = gauge;
  const MapKeyframe keyframe = keyframeOf(estimate);
  ASSERT_TRUE(keyframe.depth_m.has_value());
  EXPECT_NEAR(keyframe.depth_m->value, 20.0, 1e-12);
  EXPECT_NEAR(keyframe.depth_m->sigma, std::sqrt(0.2 * 0.2 + 0.2 * 0.2), 1e-12);
}

TEST(KeyframeDescriber, KeyframesOfTwoVisitsAreALoop) {
  // The second visit has other noise and a lamp in place of daylight.
  const TestSequence first(TestLight::daylight());
  TestLight lamp = TestLight::daylight();
  lamp.ambient_grey = 20.0;
  lamp.lamp_grey = 90.0;
  lamp.noise_grey = 2.0;
  const TestSequence second(lamp);
  const MapKeyframe old_keyframe = keyframeOfFrame(first, 0), new_keyframe = keyframeOfFrame(second, 12);
  const Loop loop = LoopVerifier().verify(old_keyframe, new_keyframe);
  ASSERT_EQ(loop.status, LoopStatus::Verified) << loop.reason;
  const Rigid3 truth = first.worldFromBody(0).inverse() * second.worldFromBody(12);
  Eigen::Matrix<double, 6, 1> error;
  error << truth.translation - loop.old_from_new.translation,
      so3::log(truth.rotation * loop.old_from_new.rotation.conjugate());
  EXPECT_LT(error.head<3>().norm(), 0.02);
  EXPECT_LT(error.dot(loop.covariance.ldlt().solve(error)), 22.46);
}

TEST(KeyframeDescriber, LeavesOutWhatTheRigCovers) {
  const TestSequence sequence(TestLight::daylight());
  const cv::Mat image = sequence.images(0).front();
  cv::Mat visible(image.size(), CV_8U, cv::Scalar(255));
  visible.colRange(0, 300).setTo(0);
  const KeyframeDescriber describer(sequence.rig());
  FrameGeometry geometry;
  geometry.cameras = describer.cameras();
  geometry.body_from_cameras.resize(2);
  const MapKeyframe keyframe = describer.describe({image}, {}, {}, geometry, visible);
  EXPECT_GT(keyframe.features.size(), 50u);
  for (const MapFeature& feature : keyframe.features) EXPECT_GE(feature.rays.front().pixel.x(), 299.0);
}

TEST(KeyframeDescriber, RefusesImagesOfAnotherSize) {
  const TestSequence sequence(TestLight::daylight());
  const KeyframeDescriber describer(sequence.rig());
  FrameGeometry geometry;
  geometry.cameras = describer.cameras();
  geometry.body_from_cameras.resize(2);
  EXPECT_THROW(describer.describe({cv::Mat(100, 100, CV_8U, cv::Scalar(0))}, {}, {}, geometry), InputError);
  EXPECT_THROW(describer.describe({cv::Mat(480, 752, CV_8UC3, cv::Scalar::all(0))}, {}, {}, geometry),
               InputError);
  EXPECT_THROW(KeyframeDescriber(Rig{}), InputError);
  EXPECT_THROW(KeyframeDescriber(sequence.rig(), {.features = 0}), UsageError);
}

TEST(UprightDescriptors, TurnWithTheVertical) {
  const TestSequence sequence(TestLight::daylight());
  const cv::Mat image = sequence.images(0).front();
  const auto camera = makeCamera(sequence.rig().cameras.front());
  constexpr double kTurned_rad = 0.7, kUp_rad = -std::numbers::pi / 2.0, kSigma_px = 2.5;
  const Vec2 centre(376.0, 240.0);
  cv::Mat turned;
  // OpenCV turns counterclockwise, in degrees.
  const cv::Mat turn = cv::getRotationMatrix2D(cv::Point2d(centre.x(), centre.y()),
                                               -kTurned_rad * 180.0 / std::numbers::pi, 1.0);
  cv::warpAffine(image, turned, turn, image.size());
  std::vector<PointToDescribe> before, after, unturned;
  for (int i = 0; i < 20; ++i) {
    const Vec2 from_centre(40.0 * (i % 5 - 2), 40.0 * (i / 5 - 2));
    const Vec2 moved = centre + Eigen::Rotation2Dd(kTurned_rad) * from_centre;
    before.push_back({centre + from_centre, kSigma_px, kUp_rad});
    after.push_back({moved, kSigma_px, kUp_rad + kTurned_rad});
    unturned.push_back({moved, kSigma_px, kUp_rad});
  }
  const EvenedImage evened(image, *camera), evened_turned(turned, *camera);
  const auto first = uprightDescriptors(evened, before);
  const auto second = uprightDescriptors(evened_turned, after);
  const auto third = uprightDescriptors(evened_turned, unturned);
  double with = 0.0, without = 0.0;
  for (size_t i = 0; i < before.size(); ++i) {
    ASSERT_TRUE(first[i] && second[i] && third[i]);
    with += distanceOf(*first[i], *second[i]) / 20.0;
    without += distanceOf(*first[i], *third[i]) / 20.0;
  }
  EXPECT_LT(with, 35.0);
  EXPECT_GT(without, 2.0 * with);
}

TEST(UprightDescriptors, AreEmptyAtTheEdge) {
  const TestSequence sequence(TestLight::daylight());
  const auto camera = makeCamera(sequence.rig().cameras.front());
  const EvenedImage plain(cv::Mat(480, 752, CV_8U, cv::Scalar(7)), *camera);
  const auto described =
      uprightDescriptors(plain, {{Vec2(3.0, 100.0), 2.5, 0.0}, {Vec2(100.0, 100.0), 2.5, {}}});
  EXPECT_FALSE(described[0]);
  EXPECT_TRUE(described[1]);
}

TEST(PointOfRays, GivesTheCrossingAndItsSigma) {
  const Vec3 point(0.3, -0.2, 3.0);
  std::vector<BodyRay> rays(2);
  rays[1].origin_B = Vec3(0.12, 0.0, 0.0);
  for (BodyRay& ray : rays) {
    ray.bearing_B = (point - ray.origin_B).normalized();
    ray.sigma_rad = 0.002;
  }
  const auto found = pointOfRays(5, rays);
  ASSERT_TRUE(found);
  EXPECT_LT((found->point_B - point).norm(), 1e-9);
  // d^2 sigma / b across the baseline.
  EXPECT_NEAR(found->distance_sigma_m, point.squaredNorm() * 0.002 / 0.12, 0.02);
  rays[1].bearing_B = rays[0].bearing_B;
  EXPECT_FALSE(pointOfRays(5, rays)) << "parallel";
}

}  // namespace
}  // namespace lodeline
