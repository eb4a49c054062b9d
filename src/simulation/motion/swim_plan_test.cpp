#include "simulation/motion/swim_plan.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <vector>

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

TEST(SwimPlan, SwimsEveryLegAndTurnsBetween) {
  SwimPlanOptions options;
  options.legs_m = {40.0, -20.0, 30.0, -50.0};
  const SwimPlan plan(options);
  double farthest_m = 0.0, last_m = 0.0;
  std::vector<double> turns_m;
  for (double t = 0.0; t < options.duration_s; t += 0.1) {
    farthest_m = std::max(farthest_m, plan.arcLength(t));
    if (plan.leg(t) != static_cast<int>(turns_m.size())) turns_m.push_back(last_m);
    last_m = plan.arcLength(t);
  }
  ASSERT_EQ(turns_m.size(), 3u);
  EXPECT_NEAR(turns_m[0], 40.0, 1e-6);
  EXPECT_NEAR(turns_m[1], 20.0, 1e-6);
  EXPECT_NEAR(turns_m[2], 50.0, 1e-6);
  EXPECT_NEAR(farthest_m, 50.0, 1e-6);
  EXPECT_NEAR(last_m, 0.0, 0.1);
  EXPECT_NEAR(plan.turn(options.duration_s), 3.0, 1e-12);
}

TEST(SwimPlan, SaysWhyADiveCannotBeSwum) {
  EXPECT_EQ(refusal(600.0, 75.0), "");
  EXPECT_THAT(refusal(60.0, 75.0), HasSubstr("a diver swims at 0.05 to 0.6 m/s"));
  EXPECT_THAT(refusal(5.0, 1.0), HasSubstr("leave no time to swim"));
}

}  // namespace
}  // namespace lodeline
