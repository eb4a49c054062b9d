#include "lodeline/estimator/magnetometer/field/anomaly_scale.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lodeline {
namespace {

constexpr double kVariance_T2 = 1e-15;  // of 0.03 uT
constexpr double kStep_m = 0.05;

/// A rig that swims along x in a field with a constant deviation.
class Swim {
 public:
  void go(double way_m, double size_T, bool agrees, double across_T = 0.0) {
    const int steps = static_cast<int>(std::lround(way_m / kStep_m));
    for (int i = 0; i < steps; ++i) {
      place_W_.x() += kStep_m;
      scale.add(place_W_, {Vec2(size_T, 0.0), kVariance_T2, across_T}, agrees);
    }
  }
  void agreeAtRest(int readings) {
    for (int i = 0; i < readings; ++i) scale.add(place_W_, {Vec2::Zero(), kVariance_T2, 0.0}, true);
  }
  AnomalyScale scale;

 private:
  Vec3 place_W_ = Vec3::Zero();
};

TEST(AnomalyScale, DoubtsTheFirstFieldUntilTheWayShowsAgreement) {
  Swim swim;
  EXPECT_DOUBLE_EQ(swim.scale.sigma_T(), AnomalyScale::kStart_T);
  swim.agreeAtRest(10000);
  EXPECT_DOUBLE_EQ(swim.scale.sigma_T(), AnomalyScale::kStart_T) << "a rig at rest learns nothing";
  swim.go(AnomalyScale::kLength_m, 0.0, true);
  const double expected = std::exp(-1.0 - AnomalyScale::kLength_m / AnomalyScale::kConfirmed_m);
  EXPECT_NEAR(swim.scale.sigma_T() / AnomalyScale::kStart_T, expected, 0.05);
  swim.go(8.0, 0.0, true);
  EXPECT_LT(swim.scale.sigma_T(), 5e-9);
}

TEST(AnomalyScale, SmallPositionErrorsOfARigAtRestAreNoWay) {
  AnomalyScale scale;
  for (int i = 0; i < 10000; ++i)
    scale.add(Vec3(0.03 * (i % 3), 0.0, 0.0), {Vec2::Zero(), kVariance_T2, 0.0}, true);
  EXPECT_DOUBLE_EQ(scale.sigma_T(), AnomalyScale::kStart_T);
}

TEST(AnomalyScale, RemembersADeviationOverMetres) {
  Swim swim;
  swim.go(20.0, 0.0, true);
  swim.scale.restartAgreement();
  swim.go(1.0, 1.4e-6, false);
  EXPECT_NEAR(swim.scale.sigma_T(), 1.4e-6 / std::sqrt(2.0), 1e-12);
  swim.go(1.0, 0.0, false);
  EXPECT_GT(swim.scale.sigma_T(), 0.5e-6) << "the anomaly can be along the heading alone at this place";
  swim.go(12.0, 0.0, false);
  EXPECT_LT(swim.scale.sigma_T(), 5e-9);
}

TEST(AnomalyScale, IsBlindToNoise) {
  Swim quiet, noisy;
  quiet.go(5.0, 0.0, true);
  noisy.go(5.0, 3.0 * std::sqrt(kVariance_T2), true);
  EXPECT_EQ(noisy.scale.sigma_T(), quiet.scale.sigma_T());
}

TEST(AnomalyScale, ConfirmsTheFieldByTheWayOfAgreementAlone) {
  Swim agreed, rejected;
  agreed.go(20.0, 0.0, true);
  agreed.go(3.0, 5e-6, false);
  EXPECT_LT(agreed.scale.sigma_T(), 0.05e-6) << "iron that is passed later does not move north";
  rejected.go(1.0, 0.0, true);
  rejected.go(5.0, 5e-6, false);
  EXPECT_GT(rejected.scale.sigma_T(), 2e-6) << "the field at the start may be the wrong one";
  agreed.scale.restartAgreement();
  EXPECT_GT(agreed.scale.sigma_T(), 2e-6);
}

TEST(AnomalyScale, ADeviationOfTheHeadingDoubtsAFieldThatIsNotConfirmed) {
  Swim swim;
  swim.go(2.0, 0.0, true, 8e-6);
  EXPECT_LT(swim.scale.sigma_T(), AnomalyScale::kStart_T) << "accepted, hence within its sigmas";
  swim.go(2.0, 0.0, false, 8e-6);
  EXPECT_NEAR(swim.scale.sigma_T(), 8e-6 / std::sqrt(2.0) * std::exp(-2.0 / AnomalyScale::kConfirmed_m),
              0.1e-6);
}

TEST(AnomalyScale, IsBounded) {
  Swim swim;
  swim.go(1.0, 1.0, false, -1.0);
  EXPECT_DOUBLE_EQ(swim.scale.sigma_T(), AnomalyScale::kMost_T);
}

}  // namespace
}  // namespace lodeline
