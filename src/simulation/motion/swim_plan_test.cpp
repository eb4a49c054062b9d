#include "simulation/motion/swim_plan.h"

#include <gmock/gmock.h>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

std::string refusal(double duration_s, double penetration_m) {
  SwimPlanOptions options;
  options.duration_s = duration_s;
  options.penetration_m = penetration_m;
  try {
    const SwimPlan plan(options);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(SwimPlan, ReachesTheFarthestPointAndComesBack) {
  SwimPlanOptions options;
  const SwimPlan plan(options);
  EXPECT_NEAR(plan.arcLength(0.0), 0.0, 0.1);
  EXPECT_NEAR(plan.arcLength(0.5 * (plan.turnBegin_s() + plan.turnEnd_s())), options.penetration_m, 0.5);
  EXPECT_NEAR(plan.arcLength(options.duration_s), 0.0, 0.5);
}

TEST(SwimPlan, SaysWhyADiveCannotBeSwum) {
  EXPECT_EQ(refusal(600.0, 75.0), "");
  EXPECT_THAT(refusal(60.0, 75.0), HasSubstr("a diver swims at 0.05 to 0.6 m/s"));
  EXPECT_THAT(refusal(5.0, 1.0), HasSubstr("leave no time to swim"));
}

}  // namespace
}  // namespace lodeline
