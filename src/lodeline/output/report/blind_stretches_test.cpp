#include "lodeline/output/report/blind_stretches.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lodeline {
namespace {

using testing::HasSubstr;

/// Frames at 10 Hz with one letter of `status` each: w(aiting), t(racking), i(nertial).
BlindStretches stretchesOf(const std::string& status) {
  BlindStretches stretches;
  double sigma_m = 0.1;
  for (size_t i = 0; i < status.size(); ++i) {
    FrameEstimate estimate;
    estimate.time = Time::fromSeconds(100.0 + 0.1 * static_cast<double>(i));
    estimate.status = status[i] == 'w'   ? Status::Waiting
                      : status[i] == 't' ? Status::Tracking
                                         : Status::Inertial;
    sigma_m = status[i] == 'i' ? sigma_m + 0.1 : 0.1;
    estimate.covariance(0, 0) = sigma_m * sigma_m;
    stretches.add(estimate);
  }
  return stretches;
}

TEST(BlindStretches, SpanFromTheFirstBlindFrameToTheNextWithImages) {
  const BlindStretches stretches = stretchesOf("wwttiiiiitt");
  ASSERT_EQ(stretches.stretches().size(), 1u);
  EXPECT_NEAR(stretches.stretches()[0].seconds(), 0.5, 1e-9);
  EXPECT_NEAR(stretches.stretches()[0].sigma_start_m, 0.1, 1e-9);
  EXPECT_NEAR(stretches.stretches()[0].sigma_end_m, 0.6, 1e-9);
}

TEST(BlindStretches, TheLongestIsReportedWithItsTimes) {
  const BlindStretches stretches = stretchesOf("ttiiitttttiiiiiiiitttii");
  EXPECT_EQ(stretches.stretches().size(), 3u);
  Diagnostics diagnostics;
  stretches.report(Time::fromSeconds(100.0), 0.25, &diagnostics);
  ASSERT_EQ(diagnostics.count("blind_stretch"), 1);
  const std::string message = diagnostics.ranked()[0].first_message;
  EXPECT_THAT(message, HasSubstr("0:01.0 to 0:01.8"));
  EXPECT_THAT(message, HasSubstr("from 0.1 m to 0.9 m"));
  EXPECT_THAT(message, HasSubstr("longest of 2"));
  EXPECT_EQ(diagnostics.ranked()[0].severity, Severity::Warning);
}

TEST(BlindStretches, SightedRunsAndShortLossesReportNothing) {
  Diagnostics diagnostics;
  stretchesOf("wwttttttt").report(Time::fromSeconds(100.0), 0.5, &diagnostics);
  stretchesOf("ttitttiit").report(Time::fromSeconds(100.0), 0.5, &diagnostics);
  EXPECT_TRUE(diagnostics.ranked().empty());
}

}  // namespace
}  // namespace lodeline
