#include "lodeline/mapping/recognition/loop_verifier.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/recognition/merge_keyframes.h"
#include "lodeline/mapping/recognition/test_loop_scene.h"

namespace lodeline {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;

/// Perturbation [dp, dtheta] that takes the estimate to the truth.
Vec6 errorOf(const Loop& loop, const Rigid3& truth) {
  Vec6 error;
  error << truth.translation - loop.old_from_new.translation,
      so3::log(truth.rotation * loop.old_from_new.rotation.conjugate());
  return error;
}

/// One place seen twice, `shared` of the points in common.
struct Revisit {
  MapKeyframe old_keyframe, new_keyframe;
  Rigid3 old_from_new;

  Revisit(SceneMaker* maker, int shared, int others, const SceneErrors& errors = {}) {
    const auto common = maker->points(shared);
    const Rigid3 first = maker->pose(0.4, 0.2), second = maker->pose(0.4, 0.2);
    old_keyframe = maker->keyframe(with(common, maker->points(others)), first, errors);
    new_keyframe = maker->keyframe(with(common, maker->points(others)), second, errors);
    old_from_new = first.inverse() * second;
  }
  static std::vector<ScenePoint> with(std::vector<ScenePoint> points, const std::vector<ScenePoint>& more) {
    points.insert(points.end(), more.begin(), more.end());
    return points;
  }
};

/// Options for scenes without errors of the calibration.
LoopVerifierOptions perfectCalibration() {
  LoopVerifierOptions options;
  options.common_distance_error = 0.0;
  options.common_rotation_rad = 0.0;
  return options;
}

TEST(LoopVerifier, FindsTrueLoopsWithinTheirCovariance) {
  SceneMaker maker(11);
  const LoopVerifier verifier(perfectCalibration());
  constexpr int kDraws = 100;
  double nees = 0.0;
  int beyond = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    SceneErrors errors;
    errors.share_with_point = draw % 2 == 0 ? 1.0 : 0.6;
    const Revisit revisit(&maker, 60, 60, errors);
    const Loop loop = verifier.verify(revisit.old_keyframe, revisit.new_keyframe);
    ASSERT_EQ(loop.status, LoopStatus::Verified) << "draw " << draw << ": " << loop.reason;
    ASSERT_GT(loop.inliers, 25);
    ASSERT_EQ(loop.inlier_matches.size(), static_cast<size_t>(loop.inliers));
    const Vec6 error = errorOf(loop, revisit.old_from_new);
    const double squared = error.dot(loop.covariance.ldlt().solve(error));
    nees += squared / kDraws;
    beyond += squared > 22.46 ? 1 : 0;
  }
  // The mean of 100 draws of chi squared with 6 degrees of freedom is 6 +- 0.35. The design effect is at
  // least 1, which makes the covariance wider in some draws.
  EXPECT_LT(nees, 7.1);
  EXPECT_GT(nees, 3.0);
  EXPECT_LE(beyond, 2) << "expected in 100 draws: 0.1";
}

TEST(LoopVerifier, CovarianceContainsErrorsOfTheCalibration) {
  SceneMaker maker(12);
  const LoopVerifier verifier;
  double nees = 0.0;
  constexpr int kDraws = 40;
  for (int draw = 0; draw < kDraws; ++draw) {
    Revisit revisit(&maker, 70, 40);
    for (MapFeature& feature : revisit.new_keyframe.features) *feature.point_B *= 1.0 + 0.002;
    const Loop loop = verifier.verify(revisit.old_keyframe, revisit.new_keyframe);
    ASSERT_EQ(loop.status, LoopStatus::Verified) << loop.reason;
    const Vec6 error = errorOf(loop, revisit.old_from_new);
    nees += error.dot(loop.covariance.ldlt().solve(error)) / kDraws;
  }
  EXPECT_LT(nees, 7.5);
}

TEST(LoopVerifier, ListsTheRightInliers) {
  SceneMaker maker(13);
  const Revisit revisit(&maker, 60, 60);
  const Loop loop = LoopVerifier().verify(revisit.old_keyframe, revisit.new_keyframe);
  ASSERT_EQ(loop.status, LoopStatus::Verified) << loop.reason;
  for (const FeatureMatch& match : loop.inlier_matches) {
    EXPECT_LT(match.old_feature, 60);
    EXPECT_EQ(match.old_feature, match.new_feature);
  }
}

TEST(LoopVerifier, GivesTheSameResultTwice) {
  SceneMaker maker(14);
  const Revisit revisit(&maker, 50, 100);
  const Loop first = LoopVerifier().verify(revisit.old_keyframe, revisit.new_keyframe);
  const Loop second = LoopVerifier().verify(revisit.old_keyframe, revisit.new_keyframe);
  EXPECT_EQ(first.old_from_new.matrix(), second.old_from_new.matrix());
  EXPECT_EQ(first.covariance, second.covariance);
}

TEST(LoopVerifier, RefusesWhatThePredictionExcludes) {
  SceneMaker maker(15);
  const Revisit revisit(&maker, 60, 40);
  LoopPrediction prediction{revisit.old_from_new, 0.01 * Mat6::Identity()};
  const Loop agrees = LoopVerifier().verify(revisit.old_keyframe, revisit.new_keyframe, prediction);
  EXPECT_EQ(agrees.status, LoopStatus::Verified) << agrees.reason;
  EXPECT_LT(agrees.mahalanobis_squared, 1.0);
  prediction.old_from_new.translation.x() += 1.0;
  const Loop contradicts = LoopVerifier().verify(revisit.old_keyframe, revisit.new_keyframe, prediction);
  EXPECT_EQ(contradicts.status, LoopStatus::Matched);
  EXPECT_NE(contradicts.reason.find("from the prediction"), std::string::npos) << contradicts.reason;
}

TEST(LoopVerifier, FindsMoreWithANarrowPrediction) {
  // Descriptors so weak that many wrong ones are nearer than the right one.
  SceneMaker maker(16);
  SceneErrors errors;
  errors.flipped_bits = 40;
  const Revisit revisit(&maker, 60, 240, errors);
  const LoopPrediction prediction{revisit.old_from_new, 1e-4 * Mat6::Identity()};
  const Loop without = LoopVerifier().verify(revisit.old_keyframe, revisit.new_keyframe);
  const Loop with = LoopVerifier().verify(revisit.old_keyframe, revisit.new_keyframe, prediction);
  EXPECT_GE(with.inliers, without.inliers);
  EXPECT_EQ(with.status, LoopStatus::Verified) << with.reason;
}

// Within so narrow a cone, chance alone makes inliers of matches. The same matches found in the whole view
// are evidence.
TEST(LoopVerifier, ANarrowPredictionHidesNoPlace) {
  SceneMaker maker(18);
  for (const double sigma : {1e-2, 3e-3, 1e-3}) {
    const Revisit revisit(&maker, 30, 60);
    const LoopPrediction prediction{revisit.old_from_new, sigma * sigma * Mat6::Identity()};
    const Loop loop = LoopVerifier().verify(revisit.old_keyframe, revisit.new_keyframe, prediction);
    EXPECT_EQ(loop.status, LoopStatus::Verified) << sigma << ": " << loop.reason;
    const Revisit other(&maker, 0, 90);
    EXPECT_NE(LoopVerifier().verify(other.old_keyframe, other.new_keyframe, prediction).status,
              LoopStatus::Verified);
  }
}

TEST(LoopVerifier, RefusesAPoseAgainstGravity) {
  SceneMaker maker(17);
  Revisit revisit(&maker, 80, 0);
  // The rig is tilted by 5 degrees more than its odometry says.
  const Rigid3 turned(so3::exp(Vec3(0.09, 0.0, 0.0)), Vec3::Zero());
  revisit.new_keyframe.odom_from_body = revisit.new_keyframe.odom_from_body * turned;
  const Loop loop = LoopVerifier().verify(revisit.old_keyframe, revisit.new_keyframe);
  EXPECT_NE(loop.status, LoopStatus::Verified);
  EXPECT_FALSE(loop.reason.empty());
}

TEST(LoopVerifier, RefusesWhatTheSecondCameraContradicts) {
  SceneMaker maker(18);
  Revisit revisit(&maker, 80, 0);
  for (MapKeyframe* keyframe : {&revisit.old_keyframe, &revisit.new_keyframe}) {
    for (MapFeature& feature : keyframe->features)
      feature.rays[1].bearing_B = (feature.rays[1].bearing_B + Vec3(0.0, 0.0, 0.02)).normalized();
  }
  const Loop loop = LoopVerifier().verify(revisit.old_keyframe, revisit.new_keyframe);
  EXPECT_NE(loop.reason.find("further camera"), std::string::npos) << loop.reason;
}

TEST(LoopVerifier, RefusesTwoPosesOfSimilarSupport) {
  SceneMaker maker(19);
  const auto first = maker.points(60), second = maker.points(60);
  const Rigid3 shift(Quat::Identity(), Vec3(0.0, 0.8, 0.0));
  std::vector<ScenePoint> before = Revisit::with(first, second), after = first;
  for (ScenePoint point : second) {
    point.position_W = shift * point.position_W;
    after.push_back(point);
  }
  const Loop loop = LoopVerifier().verify(maker.keyframe(before, Rigid3()), maker.keyframe(after, Rigid3()));
  EXPECT_NE(loop.reason.find("not unique"), std::string::npos) << loop.reason;
}

TEST(LoopVerifier, RefusesPointsThatAreAllFarAway) {
  SceneMaker maker(20);
  auto points = maker.points(100);
  for (ScenePoint& point : points) point.position_W *= 200.0;
  const Loop loop = LoopVerifier().verify(maker.keyframe(points, Rigid3()), maker.keyframe(points, Rigid3()));
  EXPECT_EQ(loop.status, LoopStatus::Candidate);
  EXPECT_NE(loop.reason.find("points with a position"), std::string::npos) << loop.reason;
}

TEST(LoopVerifier, RefusesWhatLeavesThePoseOpen) {
  // A flat wall in a view of 6 degrees: a turn looks like a shift.
  SceneMaker maker(25);
  std::vector<ScenePoint> wall;
  for (int i = 0; i < 70; ++i)
    wall.push_back({Vec3(5.0, maker.uniform(-0.26, 0.26), maker.uniform(-0.26, 0.26)), maker.look()});
  const Loop loop = LoopVerifier().verify(maker.keyframe(wall, Rigid3()), maker.keyframe(wall, Rigid3()));
  EXPECT_EQ(loop.status, LoopStatus::Matched);
  EXPECT_NE(loop.reason.find("degenerate"), std::string::npos) << loop.reason;
}

TEST(LoopVerifier, SaysWhatIsMissing) {
  SceneMaker maker(21);
  const MapKeyframe empty;
  const MapKeyframe full = maker.keyframe(maker.points(50), Rigid3());
  for (const auto& [a, b] : {std::pair(empty, empty), std::pair(full, empty), std::pair(empty, full)}) {
    const Loop loop = LoopVerifier().verify(a, b);
    EXPECT_EQ(loop.status, LoopStatus::Candidate);
    EXPECT_FALSE(loop.reason.empty());
  }
  EXPECT_THROW(LoopVerifier({.max_false_alarms = 0.0}), UsageError);
  EXPECT_THROW(LoopVerifier({.min_covered_share = 1.5}), UsageError);
}

/// Pairs of keyframes of different places that look alike.
class LookAlikes : public testing::Test {
 protected:
  static constexpr int kFeatures = 32;
  SceneMaker maker_{99};
  LoopVerifier verifier_;
  int accepted_ = 0, matched_ = 0;

  void examine(const MapKeyframe& a, const MapKeyframe& b) {
    const Loop loop = verifier_.verify(a, b);
    accepted_ += loop.status == LoopStatus::Verified ? 1 : 0;
    matched_ += loop.status == LoopStatus::Matched ? 1 : 0;
  }
  MapKeyframe keyframe(const std::vector<ScenePoint>& points) {
    return maker_.keyframe(points, maker_.pose(0.4, 0.2));
  }
};

TEST_F(LookAlikes, RandomDescriptorsAreNeverAccepted) {
  for (int i = 0; i < 4000; ++i)
    examine(keyframe(maker_.points(kFeatures)), keyframe(maker_.points(kFeatures)));
  EXPECT_EQ(accepted_, 0);
}

TEST_F(LookAlikes, ShuffledDescriptorsAreNeverAccepted) {
  for (int i = 0; i < 2000; ++i) {
    auto points = maker_.points(kFeatures);
    const MapKeyframe first = keyframe(points);
    for (size_t k = points.size() - 1; k > 0; --k)
      std::swap(points[k].look, points[maker_.below(k + 1)].look);
    examine(first, keyframe(points));
  }
  EXPECT_EQ(accepted_, 0);
  EXPECT_GT(matched_, 1900) << "the geometry had to decide";
}

TEST_F(LookAlikes, TheSameDescriptorsElsewhereAreNeverAccepted) {
  for (int i = 0; i < 2000; ++i) {
    const auto points = maker_.points(kFeatures);
    auto elsewhere = maker_.points(kFeatures);
    // Neighbours stay neighbours, but no rigid motion relates both places: each point is half a metre off.
    for (size_t k = 0; k < points.size(); ++k)
      elsewhere[k] = {points[k].position_W + maker_.normal3(0.3), points[k].look};
    examine(keyframe(points), keyframe(elsewhere));
  }
  EXPECT_EQ(accepted_, 0);
  EXPECT_GT(matched_, 1900) << "the geometry had to decide";
}

TEST_F(LookAlikes, RepeatedTextureIsNeverAccepted) {
  // Both places show few looks, many times each.
  for (int i = 0; i < 1000; ++i) {
    std::vector<Descriptor> looks;
    for (int k = 0; k < 6; ++k) looks.push_back(maker_.look());
    auto first = maker_.points(kFeatures), second = maker_.points(kFeatures);
    for (auto* points : {&first, &second})
      for (ScenePoint& point : *points) point.look = looks[maker_.below(looks.size())];
    examine(keyframe(first), keyframe(second));
  }
  EXPECT_EQ(accepted_, 0);
}

TEST_F(LookAlikes, OneObjectAtTwoPlacesIsNeverAccepted) {
  // An object 0.4 m wide, seen at 3 m, with a third of the features.
  for (int i = 0; i < 1000; ++i) {
    std::vector<ScenePoint> object;
    for (int k = 0; k < kFeatures / 2; ++k) {
      object.push_back({Vec3(3.0, maker_.uniform(-0.2, 0.2), maker_.uniform(-0.2, 0.2)), maker_.look()});
    }
    examine(keyframe(Revisit::with(object, maker_.points(kFeatures))),
            keyframe(Revisit::with(object, maker_.points(kFeatures))));
  }
  EXPECT_EQ(accepted_, 0);
  EXPECT_GT(matched_, 900) << "the cover had to decide";
}

TEST(MergeKeyframes, LetsAClipBeVerifiedWhereOneKeyframeIsTooLittle) {
  SceneMaker maker(22);
  const auto points = maker.points(28);
  const MapKeyframe old_keyframe = maker.keyframe(points, Rigid3());
  // Four keyframes of a clip, each of which sees another quarter of the scene.
  std::vector<MapKeyframe> clip;
  Rigid3 odom_from_world;
  for (size_t k = 0; k < 4; ++k) {
    const Rigid3 pose(Quat::Identity(), Vec3(0.1 * static_cast<double>(k), 0.0, 0.0));
    const std::vector<ScenePoint> seen(points.begin() + static_cast<ptrdiff_t>(7 * k),
                                       points.begin() + static_cast<ptrdiff_t>(7 * (k + 1)));
    clip.push_back(maker.keyframe(seen, pose));
    if (k == 0) odom_from_world = clip.back().odom_from_body * pose.inverse();
    clip.back().odom_from_body = odom_from_world * pose;
    for (MapFeature& feature : clip.back().features) feature.track += static_cast<TrackId>(100 * k);
  }
  EXPECT_NE(LoopVerifier().verify(old_keyframe, clip.back()).status, LoopStatus::Verified);
  const MapKeyframe merged = mergeKeyframes(clip);
  EXPECT_EQ(merged.id, clip.back().id);
  EXPECT_EQ(merged.features.size(), 28u);
  const Loop loop = LoopVerifier().verify(old_keyframe, merged);
  ASSERT_EQ(loop.status, LoopStatus::Verified) << loop.reason;
  const Vec6 error = errorOf(loop, Rigid3(Quat::Identity(), Vec3(0.3, 0.0, 0.0)));
  EXPECT_LT(error.dot(loop.covariance.ldlt().solve(error)), 22.46);
}

TEST(MergeKeyframes, KeepsOneOfEachLook) {
  SceneMaker maker(23);
  const auto points = maker.points(30);
  SceneErrors exact;
  exact.flipped_bits = 0;
  std::vector<MapKeyframe> clip{maker.keyframe(points, Rigid3(), exact),
                                maker.keyframe(points, Rigid3(), exact)};
  clip[1].odom_from_body = clip[0].odom_from_body;
  EXPECT_EQ(mergeKeyframes(clip).features.size(), 30u);
}

TEST(MergeKeyframes, RefusesWhatIsNoClip) {
  SceneMaker maker(24);
  std::vector<MapKeyframe> clip{maker.keyframe(maker.points(5), Rigid3()),
                                maker.keyframe(maker.points(5), Rigid3())};
  EXPECT_THROW(mergeKeyframes({}), UsageError);
  std::swap(clip[0], clip[1]);
  EXPECT_THROW(mergeKeyframes(clip), UsageError);
  std::swap(clip[0], clip[1]);
  clip[1].dive = 3;
  EXPECT_THROW(mergeKeyframes(clip), UsageError);
}

}  // namespace
}  // namespace lodeline
