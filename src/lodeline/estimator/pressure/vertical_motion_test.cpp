#include "lodeline/estimator/pressure/vertical_motion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lodeline {
namespace {

Time at(double time_s) { return Time::fromNanoseconds(static_cast<int64_t>(std::llround(1e9 * time_s))); }

/// A breathing diver: 5 cm up and down each 4 s while sinking at 0.1 m/s.
constexpr double kOmega = 2.0 * M_PI / 4.0;
double heightOf(double t) { return 0.05 * std::sin(kOmega * t) - 0.1 * t; }
double speedOf(double t) { return 0.05 * kOmega * std::cos(kOmega * t) - 0.1; }

VerticalMotion breathing() {
  VerticalMotion motion;
  for (int i = 0; i <= 450; ++i) motion.add(at(i / 15.0), speedOf(i / 15.0));
  return motion;
}

/// Height that a gauge with a lag shows in the steady state, from the response of a first-order filter to a
/// sine and a ramp.
double laggingHeightOf(double t, double lag_s) {
  const double gain = 1.0 / std::sqrt(1.0 + std::pow(kOmega * lag_s, 2));
  return 0.05 * gain * std::sin(kOmega * t - std::atan(kOmega * lag_s)) - 0.1 * (t - lag_s);
}

TEST(VerticalMotion, IntegratesTheRiseBetweenTwoMoments) {
  EXPECT_NEAR(breathing().riseSince(at(28.03), at(29.21), 0.0), heightOf(29.21) - heightOf(28.03), 2e-4);
}

TEST(VerticalMotion, KnowsWhatALaggingGaugeShows) {
  const VerticalMotion motion = breathing();
  for (const double lag_s : {0.05, 0.3, 1.0, 2.0}) {
    EXPECT_NEAR(motion.riseSince(at(29.1), at(29.2), lag_s), heightOf(29.2) - laggingHeightOf(29.1, lag_s),
                5e-4)
        << lag_s;
  }
}

TEST(VerticalMotion, KnowsHowWhatItShowsChanges) {
  EXPECT_NEAR(breathing().shownRise(at(27.0), at(29.2), 0.7),
              laggingHeightOf(29.2, 0.7) - laggingHeightOf(27.0, 0.7), 5e-4);
}

TEST(VerticalMotion, LagPassesSmoothlyThroughZero) {
  const VerticalMotion motion = breathing();
  const double before = motion.riseSince(at(29.1), at(29.2), -1e-3);
  const double after = motion.riseSince(at(29.1), at(29.2), 1e-3);
  EXPECT_NEAR((after - before) / 2e-3, speedOf(29.1), 1e-2);
}

TEST(VerticalMotion, HasNotMovedWhereNothingIsKnown) {
  VerticalMotion motion;
  EXPECT_EQ(motion.riseSince(at(1.0), at(2.0), 0.5), 0.0);
  motion.add(at(2.0), 0.3);
  EXPECT_NEAR(motion.riseSince(at(1.9), at(2.0), 0.5), 0.03, 1e-12);
}

TEST(VerticalMotion, LaterWordOnTheSameMomentReplacesTheEarlier) {
  VerticalMotion motion;
  motion.add(at(1.0), 0.0);
  motion.add(at(2.0), 5.0);
  motion.add(at(2.0), 0.2);
  EXPECT_NEAR(motion.riseSince(at(1.0), at(2.0), 0.0), 0.1, 1e-12);
}

}  // namespace
}  // namespace lodeline
