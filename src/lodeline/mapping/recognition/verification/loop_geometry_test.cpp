#include "lodeline/mapping/recognition/verification/loop_geometry.h"

#include <gtest/gtest.h>

#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/recognition/test_loop_scene.h"
#include "lodeline/mapping/recognition/verification/false_alarms.h"
#include "lodeline/mapping/recognition/verification/loop_pose.h"
#include "lodeline/mapping/recognition/verification/upright_two_point.h"

namespace lodeline {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;

Rigid3 movedBy(const Rigid3& pose, const Vec6& step) {
  return {so3::exp(step.tail<3>()) * pose.rotation, pose.translation + step.head<3>()};
}

/// Two keyframes of the same points with the pose of the second body in the first.
struct Pair {
  MapKeyframe old_keyframe, new_keyframe;
  Rigid3 old_from_new;

  Pair(SceneMaker* maker, int count, const SceneErrors& in_old, const SceneErrors& in_new) {
    const auto points = maker->points(count);
    const Rigid3 first = maker->pose(0.3, 0.2), second = maker->pose(0.3, 0.2);
    old_keyframe = maker->keyframe(points, first, in_old);
    new_keyframe = maker->keyframe(points, second, in_new);
    old_from_new = first.inverse() * second;
  }
  LoopCorrespondence at(int i) const { return *correspondenceOf(old_keyframe, new_keyframe, {i, i}); }
};

TEST(UprightTwoPoint, FindsThePoseOfAGeneralizedCamera) {
  SceneMaker maker(1);
  int solved = 0;
  for (int draw = 0; draw < 200; ++draw) {
    const Rigid3 truth(Quat(Eigen::AngleAxisd(maker.uniform(-3.1, 3.1), Vec3::UnitZ())), maker.normal3(2.0));
    std::vector<PointOnRay> samples;
    for (int i = 0; i < 2; ++i) {
      const Vec3 point_S = maker.normal3(4.0), origin_T = maker.normal3(0.2);
      samples.push_back({point_S, origin_T, (truth * point_S - origin_T).normalized()});
    }
    bool is_found = false;
    for (const Rigid3& pose : posesOfTwoPoints(samples[0], samples[1])) {
      is_found = is_found || ((pose.translation - truth.translation).norm() < 1e-6 &&
                              pose.rotation.angularDistance(truth.rotation) < 1e-6);
      for (const PointOnRay& sample : samples) {
        const Vec3 line = pose * sample.point_S - sample.origin_T;
        EXPECT_LT(line.normalized().cross(sample.bearing_T).norm(), 1e-6)
            << "every solution lies on both rays";
      }
    }
    solved += is_found ? 1 : 0;
  }
  EXPECT_GT(solved, 190) << "all but nearly degenerate samples";
}

TEST(UprightTwoPoint, RefusesSamplesThatLeaveYawOpen) {
  const PointOnRay first{{0.0, 0.0, 1.0}, Vec3::Zero(), Vec3(1.0, 0.0, 0.2).normalized()};
  const PointOnRay above{{0.0, 0.0, 2.0}, Vec3::Zero(), Vec3(1.0, 0.0, 0.4).normalized()};
  EXPECT_TRUE(posesOfTwoPoints(first, first).empty());
  EXPECT_TRUE(posesOfTwoPoints(first, above).empty()) << "a vertical line looks the same from all sides";
}

TEST(LoopResidual, IsZeroAtTheTruth) {
  SceneMaker maker(2);
  SceneErrors none;
  none.sigma_rad = 1e-9;
  SceneErrors rays = none;
  rays.share_with_point = 0.0;
  const Pair both(&maker, 20, none, none), old_points(&maker, 20, none, rays),
      new_points(&maker, 20, rays, none);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(residualOf(both.at(i), both.old_from_new, false).rows, 3);
    EXPECT_EQ(residualOf(old_points.at(i), old_points.old_from_new, false).rows, 2);
    for (const Pair* pair : {&both, &old_points, &new_points}) {
      const LoopResidual residual = residualOf(pair->at(i), pair->old_from_new, false);
      ASSERT_TRUE(residual.is_valid);
      EXPECT_LT(residual.squared(), 40.0) << "in sigmas of 1e-9 rad";
    }
  }
}

TEST(LoopResidual, JacobianMatchesDifferences) {
  SceneMaker maker(3);
  SceneErrors rays;
  rays.share_with_point = 0.0;
  for (const auto& [in_old, in_new] : {std::pair(SceneErrors{}, rays), std::pair(rays, SceneErrors{}),
                                       std::pair(SceneErrors{}, SceneErrors{})}) {
    const Pair pair(&maker, 20, in_old, in_new);
    for (int i = 0; i < 10; ++i) {
      const LoopResidual residual = residualOf(pair.at(i), pair.old_from_new, true);
      ASSERT_TRUE(residual.is_valid);
      for (int k = 0; k < 6; ++k) {
        constexpr double kStep = 1e-6;
        const Vec3 ahead =
            residualOf(pair.at(i), movedBy(pair.old_from_new, kStep * Vec6::Unit(k)), false).whitened;
        const Vec3 back =
            residualOf(pair.at(i), movedBy(pair.old_from_new, -kStep * Vec6::Unit(k)), false).whitened;
        const Vec3 numeric = (ahead - back) / (2.0 * kStep);
        // The weights, which count as constant, change by a small part of the residual.
        EXPECT_LT((numeric - residual.by_pose.col(k)).norm(), 0.02 * (1.0 + residual.by_pose.norm()));
      }
    }
  }
}

TEST(LoopResidual, IsWhiteForTheErrorsThatTheKeyframesState) {
  SceneMaker maker(4);
  Mat3 sum = Mat3::Zero();
  int count = 0;
  for (int draw = 0; draw < 50; ++draw) {
    const Pair pair(&maker, 50, {}, {});
    const int last =
        static_cast<int>(std::min(pair.old_keyframe.features.size(), pair.new_keyframe.features.size()));
    for (int i = 0; i < last; ++i) {
      const LoopResidual residual = residualOf(pair.at(i), pair.old_from_new, false);
      if (!residual.is_valid || residual.rows != 3) continue;
      sum += residual.whitened * residual.whitened.transpose();
      ++count;
    }
  }
  EXPECT_LT((sum / count - Mat3::Identity()).cwiseAbs().maxCoeff(), 0.12) << sum / count;
}

TEST(LoopResidual, DoesNotHoldForPointsBehindTheCamera) {
  SceneMaker maker(5);
  const Pair pair(&maker, 10, {}, {});
  const Rigid3 behind(Quat(Eigen::AngleAxisd(3.1, Vec3::UnitZ())), Vec3::Zero());
  EXPECT_FALSE(residualOf(pair.at(0), behind, true).is_valid);
  EXPECT_FALSE(isInlier(residualOf(pair.at(0), behind, true)));
}

TEST(LoopGeometry, HasNoCorrespondenceWithoutAPosition) {
  SceneMaker maker(6);
  SceneErrors rays;
  rays.share_with_point = 0.0;
  const Pair pair(&maker, 10, rays, rays);
  EXPECT_FALSE(correspondenceOf(pair.old_keyframe, pair.new_keyframe, {0, 0}));
}

TEST(CommonVertical, JacobianMatchesDifferences) {
  SceneMaker maker(7);
  const Pair pair(&maker, 5, {}, {});
  const CommonVertical vertical(pair.old_keyframe, pair.new_keyframe);
  Eigen::Matrix<double, 2, 6> by_pose, unused;
  EXPECT_LT(vertical.residual(pair.old_from_new.rotation, &by_pose).norm(), 4.0);
  for (int k = 0; k < 6; ++k) {
    const Vec6 step = 1e-6 * Vec6::Unit(k);
    const Vec2 numeric = (vertical.residual(movedBy(pair.old_from_new, step).rotation, &unused) -
                          vertical.residual(movedBy(pair.old_from_new, -step).rotation, &unused)) /
                         2e-6;
    EXPECT_LT((numeric - by_pose.col(k)).norm(), 1e-4 * (1.0 + by_pose.norm()));
  }
}

TEST(RefinePose, ConvergesFromNearby) {
  SceneMaker maker(8);
  SceneErrors fine;
  fine.sigma_rad = 1e-5;
  fine.tilt_sigma_rad = 0.0;
  const Pair pair(&maker, 60, fine, fine);
  std::vector<LoopCorrespondence> pairs;
  for (int i = 0; i < 50; ++i) pairs.push_back(pair.at(i));
  Vec6 away;
  away << 0.02, -0.02, 0.01, 0.005, -0.004, 0.006;
  const RefinedPose refined =
      refinePose(pairs, std::vector<bool>(pairs.size(), true),
                 CommonVertical(pair.old_keyframe, pair.new_keyframe), movedBy(pair.old_from_new, away), 50);
  EXPECT_TRUE(refined.is_determined);
  EXPECT_LT((refined.old_from_new.translation - pair.old_from_new.translation).norm(), 1e-3);
  EXPECT_LT(refined.old_from_new.rotation.angularDistance(pair.old_from_new.rotation), 1e-4);
}

TEST(FalseAlarms, FollowTheBinomialBound) {
  // (10 - 2) * 4 * C(10, 5) * C(5, 2) * 0.01^3
  EXPECT_NEAR(log10FalseAlarms(10, 5, 0.01), std::log10(32.0 * 252.0 * 10.0 * 1e-6), 1e-9);
  EXPECT_GT(log10FalseAlarms(40, 2, 1e-6), 0.0) << "a sample always agrees with itself";
  EXPECT_LT(log10FalseAlarms(40, 12, 0.001), log10FalseAlarms(40, 11, 0.001));
  EXPECT_LT(log10FalseAlarms(40, 12, 0.001), log10FalseAlarms(40, 12, 0.002));
}

TEST(FalseAlarms, CountsNeighboursOnce) {
  SceneMaker maker(9);
  const Pair pair(&maker, 60, {}, {});
  const ViewGrid view(pair.old_keyframe), other(pair.new_keyframe);
  std::vector<LoopCorrespondence> pairs;
  for (int i = 0; i < 50; ++i) pairs.push_back(pair.at(i));
  std::vector<LoopCorrespondence> repeated = pairs;
  repeated.insert(repeated.end(), pairs.begin(), pairs.end());
  const auto evidence = [&](const std::vector<LoopCorrespondence>& all) {
    return evidenceFor(all, std::vector<double>(all.size(), 3.2), std::vector<bool>(all.size(), true),
                       pair.old_from_new, view, other);
  };
  EXPECT_EQ(evidence(pairs).cells, evidence(repeated).cells);
  EXPECT_GT(evidence(repeated).log10_false_alarms, evidence(pairs).log10_false_alarms)
      << "more tries of the same cells are no more evidence";
}

}  // namespace
}  // namespace lodeline
