#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/store/pack/feature_block.h"
#include "lodeline/mapping/store/pack/packed_covariance.h"
#include "lodeline/mapping/store/pack/quantization.h"
#include "lodeline/mapping/store/pack/ray_functions.h"
#include "lodeline/mapping/store/test_map.h"

// Tests of what a map keeps of features and covariances, and how exactly.

namespace lodeline {
namespace {

using ::testing::HasSubstr;

double angle_rad(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Expects features to have the precision that feature_block.h states.
void expectKept(const std::vector<MapFeature>& features, const std::vector<MapFeature>& kept) {
  ASSERT_EQ(kept.size(), features.size());
  for (size_t i = 0; i < features.size(); ++i) {
    EXPECT_EQ(kept[i].track, features[i].track);
    EXPECT_EQ(kept[i].descriptor, features[i].descriptor);
    ASSERT_EQ(kept[i].rays.size(), features[i].rays.size());
    for (size_t k = 0; k < features[i].rays.size(); ++k) {
      const BodyRay &ray = features[i].rays[k], &kept_ray = kept[i].rays[k];
      EXPECT_EQ(kept_ray.camera, ray.camera);
      const double steps =
          k == 0 ? std::max(7e-5, 0.25 * ray.sigma_rad) : 0.26 * std::sqrt(2.0) * 1.06 * ray.sigma_rad;
      EXPECT_LT(angle_rad(kept_ray.bearing_B, ray.bearing_B), steps) << i << " ray " << k;
      EXPECT_NEAR(kept_ray.bearing_B.norm(), 1.0, 1e-12);
      EXPECT_LT((kept_ray.origin_B - ray.origin_B).norm(), 1.8 * RayFunctions::kOriginTolerance_m);
      EXPECT_LT((kept_ray.pixel - ray.pixel).cwiseAbs().maxCoeff(), RayFunctions::kPixelTolerance_px + 1.0);
      EXPECT_NEAR(kept_ray.sigma_rad / ray.sigma_rad, 1.0, 0.052);
    }
    ASSERT_EQ(kept[i].point_B.has_value(), features[i].point_B.has_value());
    if (!features[i].point_B) continue;
    const Vec3 along = *features[i].point_B - features[i].rays[0].origin_B;
    const double distance_m = along.norm(),
                 across_rad = 0.26 * std::sqrt(2.0) * features[i].rays[0].sigma_rad;
    const Vec3 error = *kept[i].point_B - *features[i].point_B;
    const double along_m = std::max(5.1e-4 * distance_m, 0.126 * features[i].distance_sigma_m);
    const double origin_m = 2.0 * RayFunctions::kOriginTolerance_m;
    EXPECT_LT(std::abs(error.dot(along)) / distance_m, along_m + origin_m);
    EXPECT_LT(error.norm(), along_m + origin_m + 1.06 * across_rad * distance_m);
    EXPECT_NEAR(kept[i].distance_sigma_m / features[i].distance_sigma_m, 1.0, 0.052);
  }
}

TEST(FeatureBlockTest, KeepsFeaturesOfAStereoRig) {
  std::mt19937 random(1);
  const std::vector<MapFeature> features = test::stereoFeatures(400, 0.0, &random);
  expectKept(features, unpackFeatures(packFeatures(features)));
}

TEST(FeatureBlockTest, KeepsOriginsBehindAFlatPort) {
  std::mt19937 random(2);
  const std::vector<MapFeature> features = test::stereoFeatures(400, 12.0, &random);
  expectKept(features, unpackFeatures(packFeatures(features)));
}

TEST(FeatureBlockTest, ListsWhatNoPolynomialFits) {
  std::mt19937 random(3);
  std::vector<MapFeature> features = test::stereoFeatures(300, 0.0, &random);
  std::uniform_real_distribution<double> number(-0.5, 0.5);
  for (MapFeature& feature : features) {
    for (BodyRay& ray : feature.rays) {
      ray.origin_B = Vec3(number(random), number(random), number(random));
      ray.pixel = 700.0 * Vec2(number(random), number(random));
      ray.bearing_B = Vec3(number(random), number(random), number(random)).normalized();
    }
    if (feature.point_B) *feature.point_B = Vec3(number(random), number(random), number(random));
  }
  const std::vector<MapFeature> kept = unpackFeatures(packFeatures(features));
  ASSERT_EQ(kept.size(), features.size());
  for (size_t i = 0; i < features.size(); ++i) {
    for (size_t k = 0; k < features[i].rays.size(); ++k) {
      EXPECT_LT(angle_rad(kept[i].rays[k].bearing_B, features[i].rays[k].bearing_B), 4e-4);
      EXPECT_LT((kept[i].rays[k].origin_B - features[i].rays[k].origin_B).norm(), 1e-6);
      EXPECT_LT((kept[i].rays[k].pixel - features[i].rays[k].pixel).norm(), 1e-3);
    }
    if (features[i].point_B) {
      EXPECT_LT((*kept[i].point_B - *features[i].point_B).norm(), 1.1e-3);
    }
  }
}

TEST(FeatureBlockTest, KeepsAnyNumberOfFeaturesAndTracks) {
  std::mt19937 random(4);
  for (const int count : {0, 1, 2, 19, 20, 21}) {
    std::vector<MapFeature> features = test::stereoFeatures(count, 3.0, &random);
    if (count > 1) features[1].track = 0;
    if (count > 2) features[2].track = int64_t{1} << (count == 20 ? 62 : 30);
    expectKept(features, unpackFeatures(packFeatures(features)));
  }
}

TEST(FeatureBlockTest, TakesFewBytes) {
  std::mt19937 random(5);
  const double bytes =
      static_cast<double>(packFeatures(test::stereoFeatures(400, 0.0, &random)).size()) / 400;
  const double behind_port =
      static_cast<double>(packFeatures(test::stereoFeatures(400, 12.0, &random)).size()) / 400;
  RecordProperty("bytes", std::to_string(bytes));
  RecordProperty("bytes_behind_port", std::to_string(behind_port));
  // 41.7 bytes are 5 MB in 300 keyframes; the rest of the file takes 0.7 of these. Behind a port they
  // are 42.1.
  EXPECT_LT(bytes, 40.9);
  EXPECT_LT(behind_port, 42.5);
}

TEST(FeatureBlockTest, GivesTheSameBytes) {
  std::mt19937 one(6), other(6);
  EXPECT_EQ(packFeatures(test::stereoFeatures(100, 3.0, &one)),
            packFeatures(test::stereoFeatures(100, 3.0, &other)));
}

TEST(FeatureBlockTest, RefusesWhatCannotBeKept) {
  std::mt19937 random(7);
  const auto expectRefused = [&](const char* reason, const std::function<void(MapFeature&)>& spoil) {
    std::vector<MapFeature> features = test::stereoFeatures(30, 0.0, &random);
    features[17].point_B = Vec3(0, 0, 1);
    features[17].distance_sigma_m = 0.1;
    spoil(features[17]);
    try {
      packFeatures(features);
      ADD_FAILURE() << reason;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(reason));
      EXPECT_THAT(error.what(), HasSubstr("feature 17"));
    }
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expectRefused("no ray", [](MapFeature& feature) { feature.rays.clear(); });
  expectRefused("unit", [](MapFeature& feature) { feature.rays[0].bearing_B *= 1.1; });
  expectRefused("unit", [&](MapFeature& feature) { feature.rays[0].bearing_B.x() = nan; });
  expectRefused("pixel", [&](MapFeature& feature) { feature.rays[0].pixel.x() = nan; });
  expectRefused("origin", [&](MapFeature& feature) { feature.rays[0].origin_B.z() = nan; });
  expectRefused("sigma", [](MapFeature& feature) { feature.rays[0].sigma_rad = 0.0; });
  expectRefused("sigma", [](MapFeature& feature) { feature.distance_sigma_m = -1.0; });
  expectRefused("point", [&](MapFeature& feature) { feature.point_B->x() = nan; });
  expectRefused("cameras", [](MapFeature& feature) { feature.rays[0].camera = 7; });
  expectRefused("cameras", [](MapFeature& feature) { feature.rays.push_back(feature.rays[0]); });
  expectRefused("track", [](MapFeature& feature) { feature.track = -2; });
}

TEST(FeatureBlockTest, RefusesEveryShortenedBlock) {
  std::mt19937 random(8);
  const Bytes bytes = packFeatures(test::stereoFeatures(25, 3.0, &random));
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(unpackFeatures(std::span(bytes).first(size)), InputError) << size;
}

TEST(FeatureBlockTest, SurvivesChangedBytes) {
  std::mt19937 random(9);
  const Bytes bytes = packFeatures(test::stereoFeatures(25, 3.0, &random));
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    Bytes changed = bytes;
    changed[random() % changed.size()] = static_cast<unsigned char>(random());
    try {
      unpackFeatures(changed);
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(QuantizationTest, DirectionsAreKept) {
  std::mt19937 random(10);
  std::normal_distribution<double> normal;
  for (const int steps : {1024, 16001, 65535}) {
    const DirectionGrid grid(static_cast<uint16_t>(steps));
    const auto errorOf_rad = [&](const Vec3& direction) {
      const auto [u, v] = grid.pack(direction);
      return angle_rad(grid.unpack(u, v), direction);
    };
    for (int i = 0; i < 20000; ++i) {
      const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
      ASSERT_LT(errorOf_rad(direction), 4.3 / steps);
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) EXPECT_LT(errorOf_rad(sign * Vec3::Unit(axis)), 4.3 / steps);
    }
  }
}

TEST(QuantizationTest, DistancesAreKept) {
  for (const double relative_sigma : {1e-6, 0.01, 3.0}) {
    const DistanceScale scale = DistanceScale::forSigma(relative_sigma);
    const double most = std::clamp(relative_sigma / 8.0, 0.00051, std::expm1(0.01));
    for (double distance_m = 1.1e-3; distance_m < 1e4; distance_m *= 1.37)
      EXPECT_NEAR(scale.unpack_m(scale.pack(distance_m).value()) / distance_m, 1.0, 1.001 * most);
    EXPECT_FALSE(scale.pack(0.0));
  }
  EXPECT_FALSE(DistanceScale::forSigma(1e-6).pack(1e300)) << "more than 65,535 fine steps";
}

TEST(QuantizationTest, ResidualsBeyondTheirRangeAreNone) {
  const Vec3 predicted = Vec3(0.1, -0.2, 1.0).normalized();
  const Vec3 across = tangentBasis(predicted).col(0);
  EXPECT_TRUE(packResidual((predicted + 3.7e-3 * across).normalized(), predicted, 1e-3));
  EXPECT_FALSE(packResidual((predicted + 3.8e-3 * across).normalized(), predicted, 1e-3));
  EXPECT_FALSE(packResidual(-predicted, predicted, 1e-3));
  for (int code = 0; code <= 14; ++code) EXPECT_NE(code | code << 4, kNoResidual);
}

TEST(PackedCovarianceTest, KeepsCovariances) {
  std::mt19937 random(11);
  for (const double sigma : {1e-6, 1e-2, 1e3}) {
    const Mat6 covariance = test::someCovariance(sigma, &random);
    const Mat6 kept = unpackCovariance<6>(packCovariance<6>(covariance));
    EXPECT_LT((kept - covariance).norm(), 1e-6 * covariance.norm());
  }
  EXPECT_EQ(unpackCovariance<6>(packCovariance<6>(Mat6::Zero())), Mat6::Zero());
  Mat6 fixed = test::someCovariance(0.1, &random);
  fixed.row(2).setZero();
  fixed.col(2).setZero();
  EXPECT_LT((unpackCovariance<6>(packCovariance<6>(fixed)) - fixed).norm(), 1e-8);
}

TEST(PackedCovarianceTest, RefusesWhatIsNoCovariance) {
  Mat3 matrix = Mat3::Identity();
  matrix(0, 1) = 0.5;
  EXPECT_THROW(packCovariance<3>(matrix), InputError);
  matrix(1, 0) = 0.5;
  EXPECT_NO_THROW(packCovariance<3>(matrix));
  matrix(0, 1) = matrix(1, 0) = 1.5;
  EXPECT_THROW(packCovariance<3>(matrix), InputError);
  EXPECT_THROW(packCovariance<3>(-Mat3::Identity()), InputError);
  EXPECT_THROW(packCovariance<3>(Mat3::Constant(std::numeric_limits<double>::infinity())), InputError);
  EXPECT_THROW(unpackCovariance<3>(Bytes(23)), InputError);
  EXPECT_THROW(unpackCovariance<3>(Bytes(24, 0xff)), InputError);
}

}  // namespace
}  // namespace lodeline
