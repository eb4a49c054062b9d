#include "lodeline/estimator/pressure/depth_gate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lodeline {
namespace {

constexpr double kSigma_m = 0.03;
constexpr double kPeriod_s = 0.5;

class DepthGateTest : public testing::Test {
 protected:
  DepthDecision next(double innovation_m, double sigma_m = kSigma_m) {
    time_s_ += kPeriod_s;
    return gate_.decide(Time::fromNanoseconds(static_cast<int64_t>(1e9 * time_s_)), innovation_m, sigma_m);
  }
  DepthGate gate_{DepthGateOptions()};
  double time_s_ = 0.0;
};

TEST_F(DepthGateTest, BelievesWhatIsExpectedWithFullWeight) {
  for (int i = 0; i < 20; ++i) {
    const DepthDecision decision = next(0.05 * std::sin(i));
    EXPECT_EQ(decision.status, DepthStatus::Used);
    EXPECT_EQ(decision.variance_scale, 1.0);
  }
}

TEST_F(DepthGateTest, RejectsSpikesAndNothingElse) {
  for (int i = 0; i < 40; ++i) {
    const bool spike = i % 10 == 5;
    const DepthDecision decision = next(spike ? (i % 20 == 5 ? 3.0 : -655.35) : 0.02);
    EXPECT_EQ(decision.status, spike ? DepthStatus::Jump : DepthStatus::Used) << i;
    EXPECT_EQ(decision.use, !spike);
  }
}

TEST_F(DepthGateTest, NeverLocksOutWhatCreepsAwayButWeighsItLess) {
  double scale = 1.0;
  for (int i = 0; i < 100; ++i) {
    const DepthDecision decision = next(0.02 * i);
    ASSERT_EQ(decision.status, DepthStatus::Used) << i;
    EXPECT_GE(decision.variance_scale, scale);
    scale = decision.variance_scale;
  }
  EXPECT_GT(scale, 10.0);
}

TEST_F(DepthGateTest, TakesALastingStepForANewOffset) {
  next(0.0);
  int rejected = 0;
  DepthDecision decision = next(2.0);
  for (; decision.status == DepthStatus::Jump; decision = next(2.0 + 0.01 * (rejected % 2))) ++rejected;
  EXPECT_EQ(decision.status, DepthStatus::Restarted);
  EXPECT_NEAR(rejected * kPeriod_s, DepthGateOptions().readmission_s, 1.0);
  EXPECT_EQ(next(0.01).status, DepthStatus::Used);  // relative to the new offset
}

TEST_F(DepthGateTest, DoesNotRestartOnReadingsThatJumpAbout) {
  next(0.0);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(next(i % 2 == 0 ? 5.0 : -5.0).status, DepthStatus::Jump);
}

TEST_F(DepthGateTest, OpensAsWideAsTheHeightIsUncertain) {
  next(0.0);
  EXPECT_EQ(next(0.8, 0.3).status, DepthStatus::Used);
  EXPECT_EQ(next(-0.8, 0.05).status, DepthStatus::Jump);
}

}  // namespace
}  // namespace lodeline
