#include "lodeline/mapping/cloud/local_cloud.h"

#include <gtest/gtest.h>

#include <limits>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/cloud/trials/test_tube.h"

namespace lodeline {
namespace {

/// A feature at a place of the body frame, seen by a camera at the body's origin.
MapFeature featureAt(const Vec3& point_B, double distance_sigma_m, TrackId track = -1) {
  MapFeature feature;
  feature.track = track;
  feature.point_B = point_B;
  feature.distance_sigma_m = distance_sigma_m;
  BodyRay ray;
  ray.bearing_B = point_B.normalized();
  ray.sigma_rad = 0.001;
  feature.rays.push_back(ray);
  return feature;
}

/// A grid of points on the wall z = 2 m of the body frame.
std::vector<MapFeature> wall() {
  std::vector<MapFeature> features;
  for (int i = -5; i <= 5; ++i) {
    for (int j = -5; j <= 5; ++j)
      features.push_back(featureAt(Vec3(0.2 * i + 0.05, 0.2 * j + 0.05, 2.05), 0.01));
  }
  return features;
}

MapKeyframe keyframeAt(const Vec3& place) {
  MapKeyframe keyframe;
  keyframe.odom_from_body.translation = place;
  return keyframe;
}

TEST(LocalCloud, GivesPointsTheUncertaintyOfTheirRays) {
  MapKeyframe keyframe = keyframeAt(Vec3(5.0, 1.0, -3.0));
  keyframe.features = wall();
  const LocalCloud cloud = cloudOfKeyframes({keyframe}, 0);
  ASSERT_GT(cloud.points.size(), 100u);
  for (const CloudPoint& point : cloud.points) {
    const Vec3 ray = point.view_F.normalized();
    EXPECT_NEAR(ray.dot(point.covariance_F * ray), 1e-4, 1e-9);
    const Vec3 across = tangentBasis(ray).col(0);
    EXPECT_NEAR(across.dot(point.covariance_F * across), 1e-6 * point.view_F.squaredNorm(), 1e-9);
  }
}

TEST(LocalCloud, TurnsNormalsTowardsTheCamera) {
  MapKeyframe keyframe;
  keyframe.features = wall();
  for (const CloudPoint& point : cloudOfKeyframes({keyframe}, 0).points)
    EXPECT_LT((point.normal_F - Vec3(0.0, 0.0, -1.0)).norm(), 1e-6);
}

TEST(LocalCloud, JoinsKeyframesByOdometryAndMergesTracks) {
  MapKeyframe first = keyframeAt(Vec3(0.0, 0.0, 0.0)), second = keyframeAt(Vec3(0.0, 0.0, 1.0));
  second.odom_from_body.rotation = so3::exp(Vec3(0.0, 0.3, 0.0));
  first.features = wall();
  for (size_t i = 0; i < first.features.size(); ++i) {
    first.features[i].track = static_cast<TrackId>(i);
    MapFeature again = first.features[i];
    again.point_B = second.odom_from_body.inverse() * *again.point_B;
    again.distance_sigma_m = 0.005;
    second.features.push_back(again);
  }
  const LocalCloud one = cloudOfKeyframes({first}, 0), both = cloudOfKeyframes({first, second}, 0);
  ASSERT_EQ(both.points.size(), one.points.size());
  for (size_t i = 0; i < one.points.size(); ++i) {
    EXPECT_LT((both.points[i].position_F - one.points[i].position_F).norm(), 1e-9);
    EXPECT_EQ(both.points[i].observations, 2);
    EXPECT_LT(both.points[i].covariance_F.trace(), one.points[i].covariance_F.trace());
  }
}

TEST(LocalCloud, DropsWhatIsIsolatedFarOrUncertain) {
  MapKeyframe keyframe;
  keyframe.features = wall();
  const size_t expected = cloudOfKeyframes({keyframe}, 0).points.size();
  keyframe.features.push_back(featureAt(Vec3(0.0, 0.0, 0.7), 0.01));  // floats
  keyframe.features.push_back(featureAt(Vec3(0.0, 0.0, 9.0), 0.01));  // beyond the radius
  keyframe.features.push_back(featureAt(Vec3(0.1, 0.0, 2.3), 0.5));   // uncertain
  keyframe.features.push_back(featureAt(Vec3(0.0, 0.1, 2.3), 0.0));   // of unknown uncertainty
  EXPECT_EQ(cloudOfKeyframes({keyframe}, 0).points.size(), expected);
}

TEST(LocalCloud, KeepsTheMostCertainPointOfAVoxel) {
  MapKeyframe keyframe;
  keyframe.features = wall();
  const size_t expected = cloudOfKeyframes({keyframe}, 0).points.size();
  for (MapFeature& feature : wall()) {
    feature.point_B->x() += 0.01;
    feature.distance_sigma_m = 0.004;
    keyframe.features.push_back(feature);
  }
  const LocalCloud cloud = cloudOfKeyframes({keyframe}, 0);
  EXPECT_EQ(cloud.points.size(), expected);
  for (const CloudPoint& point : cloud.points) EXPECT_LT(point.covariance_F.trace(), 7e-5);
}

TEST(LocalCloud, TakesKeyframesOfTheStretchOnly) {
  MapKeyframe far = keyframeAt(Vec3(0.0, 0.0, -30.0)), near = keyframeAt(Vec3::Zero());
  near.features = wall();
  for (MapFeature feature : wall()) {
    feature.point_B->z() += 30.0;
    feature.point_B->x() += 0.1;
    far.features.push_back(feature);
  }
  EXPECT_EQ(cloudOfKeyframes({far, near}, 1).points.size(), cloudOfKeyframes({near}, 0).points.size());
}

TEST(LocalCloud, TakesLandmarksOfARun) {
  const Rigid3 world_from_frame(so3::exp(Vec3(0.1, -0.2, 0.7)), Vec3(10.0, 20.0, -5.0));
  std::vector<SeenLandmark> landmarks;
  for (const MapFeature& feature : wall())
    landmarks.push_back({{world_from_frame * *feature.point_B, 5}, world_from_frame.translation});
  const size_t all = landmarks.size();
  landmarks.push_back({{world_from_frame * Vec3(0.0, 0.0, 1.9), 1}, world_from_frame.translation});
  const LocalCloud cloud = cloudOfLandmarks(landmarks, 7, world_from_frame);
  EXPECT_EQ(cloud.keyframe, 7);
  EXPECT_EQ(cloud.points.size(), all);
  EXPECT_LT((world_from_frame.rotation * cloud.up_F - Vec3::UnitZ()).norm(), 1e-12);
  for (const CloudPoint& point : cloud.points) EXPECT_NEAR(point.position_F.z(), 2.05, 1e-9);
}

TEST(LocalCloud, IsTheSameEveryTime) {
  const test::TubeWorld world(test::Tube{});
  std::mt19937_64 first(3), second(3);
  const auto a = cloudOfKeyframes(test::swim(world, 5.0, 20.0, {}, first), 15);
  const auto b = cloudOfKeyframes(test::swim(world, 5.0, 20.0, {}, second), 15);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (size_t i = 0; i < a.points.size(); ++i) EXPECT_EQ(a.points[i].position_F, b.points[i].position_F);
}

TEST(LocalCloud, RefusesBadInput) {
  MapKeyframe keyframe;
  keyframe.features = wall();
  EXPECT_THROW(cloudOfKeyframes({keyframe}, 1), UsageError);
  LocalCloudOptions options;
  options.neighbours = 3;
  EXPECT_THROW(cloudOfKeyframes({keyframe}, 0, options), UsageError);
  options = {};
  options.voxel_m = 0.0;
  EXPECT_THROW(cloudOfKeyframes({keyframe}, 0, options), UsageError);
  keyframe.features[0].point_B->x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(cloudOfKeyframes({keyframe}, 0), InputError);
  MapKeyframe lost;
  lost.odom_from_body.translation.x() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(cloudOfKeyframes({lost}, 0), InputError);
  EXPECT_TRUE(cloudOfKeyframes({MapKeyframe{}}, 0).points.empty());
}

}  // namespace
}  // namespace lodeline
