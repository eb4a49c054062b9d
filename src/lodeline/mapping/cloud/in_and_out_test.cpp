#include "lodeline/mapping/cloud/in_and_out.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <limits>
#include <random>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/geometry/squared.h"

namespace lodeline {
namespace {

/// 60 m along x and back, `beside_m` to the left, with a keyframe each metre. Variances grow with the path.
std::vector<MapKeyframe> thereAndBack(double beside_m) {
  std::vector<MapKeyframe> keyframes;
  for (int i = 0; i <= 120; ++i) {
    MapKeyframe keyframe;
    keyframe.id = i;
    const bool is_back = i > 60;
    keyframe.odom_from_body.translation = Vec3(is_back ? 120.0 - i : i, is_back ? beside_m : 0.0, 0.0);
    Mat3 axes;
    axes.col(2) = is_back ? Vec3(-1.0, 0.0, 0.0) : Vec3(1.0, 0.0, 0.0);
    axes.col(1) = -Vec3::UnitZ();
    axes.col(0) = axes.col(1).cross(axes.col(2));
    keyframe.odom_from_body.rotation = Quat(axes);
    Eigen::Matrix<double, 6, 1> variances;
    variances << 4e-4 * i, 4e-4 * i, 1e-4 * i, 1e-8, 1e-8, 1e-6 * i;
    keyframe.covariance = variances.asDiagonal();
    keyframes.push_back(keyframe);
  }
  return keyframes;
}

TEST(InAndOut, PairsTheWayOutWithTheWayIn) {
  const auto keyframes = thereAndBack(0.3);
  const auto pairs = inAndOutCandidates(keyframes);
  ASSERT_GE(pairs.size(), 11u);
  ASSERT_LE(pairs.size(), 16u);
  double last = 0.0;
  for (const CloudPair& pair : pairs) {
    const auto &older = keyframes[pair.old_index], &newer = keyframes[pair.new_index];
    EXPECT_GE(pair.new_index - pair.old_index, 15u);
    // Next to the turn, less than 15 m of path lie between the nearest.
    if (pair.new_index > 68) {
      EXPECT_LE((older.odom_from_body.translation - newer.odom_from_body.translation).norm(), 0.31);
    }
    EXPECT_TRUE(pair.looks_back);
    EXPECT_EQ(pair.covariance.llt().info(), Eigen::Success);
    const double uncertainty = pair.covariance.diagonal().head(3).sum();
    EXPECT_GE(uncertainty, last - 1e-12);
    last = uncertainty;
  }
  // The turn, where the uncertainty is least, comes first.
  EXPECT_LT(pairs.front().new_index, 75u);
}

TEST(InAndOut, BoundsTheNumberOfPairs) {
  InAndOutOptions options;
  options.most_pairs = 5;
  const auto pairs = inAndOutCandidates(thereAndBack(0.0), options);
  EXPECT_LE(pairs.size(), 5u);
  EXPECT_GE(pairs.size(), 2u);
}

TEST(InAndOut, LeavesOutWhatIsBeyondThePrediction) {
  EXPECT_TRUE(inAndOutCandidates(thereAndBack(8.0)).empty());
  EXPECT_TRUE(inAndOutCandidates({}).empty());
  EXPECT_FALSE(inAndOutCandidates(thereAndBack(1.8)).empty());
}

TEST(InAndOut, TellsTheDirectionOfView) {
  auto keyframes = thereAndBack(0.0);
  for (MapKeyframe& keyframe : keyframes)
    keyframe.odom_from_body.rotation = keyframes[0].odom_from_body.rotation;
  for (const CloudPair& pair : inAndOutCandidates(keyframes)) EXPECT_FALSE(pair.looks_back);
}

TEST(InAndOut, HasTheCovarianceOfTheRelativePose) {
  // Errors of a walk: each step turns and shifts all later poses. Compared with samples.
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  constexpr int kRuns = 4000;
  std::vector<MapKeyframe> keyframes = thereAndBack(0.5);
  keyframes.resize(41);
  for (size_t i = 20; i < keyframes.size(); ++i)
    keyframes[i].odom_from_body.translation = Vec3(20.0, static_cast<double>(i) - 20.0, 0.0);
  const MapKeyframe &old_truth = keyframes[10], &new_truth = keyframes[40];
  Mat6 old_sum = Mat6::Zero(), new_sum = Mat6::Zero(), relative_sum = Mat6::Zero();
  const Rigid3 relative_truth = old_truth.odom_from_body.inverse() * new_truth.odom_from_body;
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  for (int run = 0; run < kRuns; ++run) {
    Rigid3 pose = keyframes[0].odom_from_body;
    Rigid3 old_pose;
    for (size_t i = 1; i < keyframes.size(); ++i) {
      Rigid3 step = keyframes[i - 1].odom_from_body.inverse() * keyframes[i].odom_from_body;
      step.translation += 0.01 * Vec3(normal(random), normal(random), normal(random));
      step.rotation = step.rotation * so3::exp(0.003 * Vec3(0.0, normal(random), 0.0));
      pose = pose * step;
      if (i == 10) old_pose = pose;
    }
    const auto error = [](const Rigid3& truth, const Rigid3& estimate) {
      Vec6 result;
      result << truth.translation - estimate.translation,
          so3::log(truth.rotation * estimate.rotation.conjugate());
      return result;
    };
    const Vec6 of_old = error(old_truth.odom_from_body, old_pose),
               of_new = error(new_truth.odom_from_body, pose);
    const Vec6 relative = error(relative_truth, old_pose.inverse() * pose);
    old_sum += of_old * of_old.transpose() / kRuns;
    new_sum += of_new * of_new.transpose() / kRuns;
    relative_sum += relative * relative.transpose() / kRuns;
  }
  keyframes[10].covariance = old_sum;
  keyframes[40].covariance = new_sum;
  const Mat6 relative = relativeCovariance(keyframes[10], keyframes[40]);
  for (const int i : {0, 1, 2, 4}) EXPECT_NEAR(relative(i, i) / relative_sum(i, i), 1.0, 0.15) << i;
}

TEST(InAndOut, CountsHeadingsOfTheMagnetometerTwice) {
  auto keyframes = thereAndBack(0.0);
  const Mat6 before = relativeCovariance(keyframes[50], keyframes[70]);
  keyframes[50].heading_sigma_rad = keyframes[70].heading_sigma_rad = 0.02;
  const Mat6 after = relativeCovariance(keyframes[50], keyframes[70]);
  // The bodies' y axis is vertical.
  EXPECT_NEAR(after(4, 4) - before(4, 4), 2.0 * squared(0.02), 1e-6);
}

TEST(InAndOut, RefusesBadInput) {
  auto keyframes = thereAndBack(0.0);
  InAndOutOptions options;
  options.spacing_m = 0.0;
  EXPECT_THROW(inAndOutCandidates(keyframes, options), UsageError);
  options = {};
  options.view_B.setZero();
  EXPECT_THROW(inAndOutCandidates(keyframes, options), UsageError);
  keyframes[3].covariance(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(inAndOutCandidates(keyframes), InputError);
}

}  // namespace
}  // namespace lodeline
