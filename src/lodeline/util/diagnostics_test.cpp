#include "lodeline/diagnostics.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

TEST(Diagnostics, FoldsByKindAndKeepsTheFirstMessage) {
  Diagnostics diagnostics;
  diagnostics.report(Severity::Notice, "imu_gap", "first");
  diagnostics.report(Severity::Warning, "imu_gap", "second");
  ASSERT_EQ(diagnostics.ranked().size(), 1u);
  EXPECT_EQ(diagnostics.ranked()[0].first_message, "first");
  EXPECT_EQ(diagnostics.ranked()[0].severity, Severity::Warning);
  EXPECT_EQ(diagnostics.count("imu_gap"), 2);
  EXPECT_EQ(diagnostics.count("never"), 0);
}

TEST(Diagnostics, RanksBySeverityThenFrequencyThenName) {
  Diagnostics diagnostics;
  diagnostics.report(Severity::Notice, "b", "");
  diagnostics.report(Severity::Notice, "a", "");
  diagnostics.report(Severity::Notice, "often", "");
  diagnostics.report(Severity::Notice, "often", "");
  diagnostics.report(Severity::Serious, "worst", "");
  std::vector<std::string> kinds;
  for (const Finding& finding : diagnostics.ranked()) kinds.push_back(finding.kind);
  EXPECT_EQ(kinds, (std::vector<std::string>{"worst", "often", "a", "b"}));
}

}  // namespace
}  // namespace lodeline
