#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/control/control_residual.h"
#include "lodeline/mapping/control/test_control.h"
#include "lodeline/mapping/store/test_map.h"

// Tests of visits and residuals of control points.

namespace lodeline {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

Vec3 noise(double sigma, std::mt19937* random) {
  std::normal_distribution<double> normal(0.0, sigma);
  const double x = normal(*random), y = normal(*random);
  return Vec3(x, y, normal(*random));
}

SolvedPose poseAt(double x) {
  return {Rigid3(so3::exp(Vec3(0.1, -0.2, 0.3 * x)), Vec3(x, 2 * x, -3)), 1e-4 * Mat6::Identity()};
}

ControlFactor factorTo(const char* name, KeyframeId keyframe, const Vec3& point, bool is_known) {
  ControlFactor factor;
  factor.name = name;
  factor.keyframe = keyframe;
  factor.in_body = {poseAt(static_cast<double>(keyframe)).map_from_body.inverse() * point,
                    1e-4 * Mat3::Identity()};
  if (is_known) factor.in_map = PositionPrior{point, 4e-4 * Mat3::Identity()};
  return factor;
}

std::optional<SolvedPose> truePose(KeyframeId id) {
  if (id > 100) return std::nullopt;
  return poseAt(static_cast<double>(id));
}

TEST(ControlResidualTest, IsZeroAtTheTruth) {
  const std::vector<ControlFactor> factors = {
      factorTo("a", 1, Vec3(4, 5, 6), true), factorTo("b", 2, Vec3(1, 1, 1), false),
      factorTo("b", 3, Vec3(1, 1, 1), false), factorTo("c", 101, Vec3(1, 1, 1), true)};
  const std::vector<ControlPointResidual> residuals = controlResiduals(factors, truePose);
  ASSERT_EQ(residuals.size(), 3u) << "keyframe 101 has no pose";
  for (const ControlPointResidual& residual : residuals) {
    EXPECT_LT(residual.error_m.norm(), 1e-12);
    EXPECT_FALSE(residual.is_blunder);
  }
  EXPECT_THAT(blunderTexts(residuals), IsEmpty());
  EXPECT_FALSE(residuals[0].reference_keyframe);
  EXPECT_EQ(residuals[1].reference_keyframe, 2);
}

TEST(ControlResidualTest, IsWhite) {
  // Mean chi squared with 3 degrees of freedom over draws of pose, observation and statement.
  std::mt19937 random(2);
  constexpr int kDraws = 4000;
  double sum = 0.0;
  int blunders = 0;
  const Mat6 covariance = test::someCovariance(0.01, &random);
  const Mat6 factor_L = covariance.llt().matrixL();
  std::normal_distribution<double> normal;
  for (int i = 0; i < kDraws; ++i) {
    ControlFactor factor = factorTo("a", 7, Vec3(9, 13, -1), true);
    factor.in_body.position += noise(0.01, &random);
    factor.in_map->position += noise(0.02, &random);
    Eigen::Matrix<double, 6, 1> draw;
    for (double& value : draw) value = normal(random);
    draw = factor_L * draw;
    SolvedPose pose = poseAt(7);
    pose.covariance = covariance;
    pose.map_from_body.translation += draw.head<3>();
    pose.map_from_body.rotation = so3::exp(draw.tail<3>()) * pose.map_from_body.rotation;
    const auto residual = controlResiduals(std::span(&factor, 1), [&](KeyframeId) { return pose; }).front();
    sum += residual.chi_squared;
    blunders += residual.is_blunder ? 1 : 0;
  }
  // One sigma of the mean is sqrt(6 / kDraws) = 0.039.
  EXPECT_NEAR(sum / kDraws, 3.0, 0.16);
  EXPECT_LE(blunders, 14);  // 4 are expected
}

TEST(ControlResidualTest, NamesBlunders) {
  std::vector<ControlFactor> factors = {factorTo("gps", 1, Vec3(4, 5, 6), true)};
  factors[0].in_map->position.x() += 0.5;
  for (const KeyframeId keyframe : {10, 11, 12})
    factors.push_back(factorTo("tag 7", keyframe, Vec3(1, 1, 1), false));
  factors[1].in_body.position.z() += 4.3;
  factors[1].kind = ControlKind::Tag;
  const std::vector<ControlPointResidual> residuals = controlResiduals(factors, truePose);
  const std::vector<std::string> texts = blunderTexts(residuals);
  ASSERT_EQ(texts.size(), 2u);
  EXPECT_THAT(texts[0], HasSubstr("station 'gps': keyframe 1 shows it 0.50 m from its stated position"));
  EXPECT_THAT(texts[1],
              HasSubstr("tag 'tag 7': keyframe 10 shows it 4.30 m from where keyframe 11 shows it"));
  EXPECT_THAT(residualTable(residuals), HasSubstr("blunder"));
}

class VisitTest : public ::testing::Test {
 protected:
  VisitTest() {
    for (int i = 0; i < 10; ++i)
      keyframes_.push_back(
          {i + 1, start_ + Duration::fromSeconds(i), Rigid3(so3::exp(Vec3(0, 0, i)), Vec3(i, 0, 0))});
    control_.add({-1, "mark", ControlKind::Tie, {}, PositionPrior{{1, 2, 3}, Mat3::Identity()}, "c.csv:2"});
  }
  std::vector<ControlFactor> factors(double seconds, const std::string& dive = "") {
    control_.visits = {{"mark", dive, {}, Duration::fromSeconds(seconds), "c.csv:2"}};
    return factorsOfVisits(control_, "dive 1", start_, keyframes_);
  }

  Time start_ = Time::fromNanoseconds(1795255200000000000);
  std::vector<VisitedKeyframe> keyframes_;
  ControlSet control_;
};

TEST_F(VisitTest, BelongsToTheNearestKeyframe) {
  const std::vector<ControlFactor> found = factors(3.75);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].keyframe, 5);
  EXPECT_EQ(found[0].kind, ControlKind::Tie);
  EXPECT_EQ(found[0].in_map->position, Vec3(1, 2, 3));
  const Vec3 in_odom = keyframes_[4].odom_from_body * found[0].in_body.position;
  EXPECT_LT((in_odom - Vec3(3.75, 0, 0)).norm(), 1e-12);
  EXPECT_NEAR(found[0].in_body.covariance(0, 0), 0.3 * 0.3 + std::pow(0.05 * 0.25, 2), 1e-12);
  EXPECT_EQ(factors(9.0)[0].keyframe, 10);
  EXPECT_EQ(factors(10.5)[0].keyframe, 10) << "just after the last keyframe";
  EXPECT_EQ(factors(3.0, "dive 1").size(), 1u);
  EXPECT_THAT(factors(3.0, "dive 2"), IsEmpty());
}

TEST_F(VisitTest, NamesVisitsWithoutKeyframes) {
  EXPECT_THAT(
      test::errorOf([&] { factors(13.0); }),
      HasSubstr("c.csv:2: the dive dive 1 has no keyframes around the visit of 'mark', 13.0 s after"));
  keyframes_.erase(keyframes_.begin() + 2, keyframes_.begin() + 8);
  EXPECT_THAT(test::errorOf([&] { factors(5.0); }), HasSubstr("no keyframes around"));
  keyframes_.clear();
  EXPECT_THAT(test::errorOf([&] { factors(5.0); }), HasSubstr("no keyframes around"));
}

TEST_F(VisitTest, ControlOfAMapIsReadBack) {
  test::TemporaryFolder folder;
  MapFile map = MapFile::create(folder.path() / "cave.db", {});
  std::mt19937 random(1);
  MapChange change = map.change();
  const DiveId dive = change.addDive(test::namedDive("dive 1"));
  for (int i = 0; i < 10; ++i) change.addKeyframe(test::passageKeyframe(dive, i, 1, &random));
  const std::vector<ControlFactor> written = factors(3.75);
  addControl(control_, written, &change);
  change.commit();
  const std::vector<ControlFactor> read = controlFactorsOf(map);
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].name, "mark");
  EXPECT_EQ(read[0].keyframe, 5);
  EXPECT_EQ(read[0].in_body.position, written[0].in_body.position);
  EXPECT_TRUE(read[0].in_body.covariance.isApprox(written[0].in_body.covariance, 1e-6));
  EXPECT_EQ(read[0].in_map->position, Vec3(1, 2, 3));
}

}  // namespace
}  // namespace lodeline
