#include "lodeline/output/report/page/solutions.h"

#include <gtest/gtest.h>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/output/report/page/run_page.h"
#include "lodeline/output/report/page/test_run.h"

namespace lodeline {
namespace {

using test::TemporaryFolder;

class Solutions : public testing::Test {
 protected:
  void SetUp() override { test::writeTestRun(folder_.path()); }
  nlohmann::ordered_json others() { return runPageJson(folder_.path(), {}, &diagnostics_)["others"]; }
  TemporaryFolder folder_;
  Diagnostics diagnostics_;
};

double at(const nlohmann::ordered_json& solution, const char* column, size_t row) {
  return solution["states"]["numbers"][column][row].get<double>();
}

TEST_F(Solutions, PosesBetweenKeyframesOfTheMapFollowByOdometry) {
  const auto solutions = others();
  ASSERT_EQ(solutions.size(), 1u);
  EXPECT_EQ(solutions[0]["kind"], "map");
  EXPECT_EQ(solutions[0]["states"]["total"], 200);
  // The test's map lies half a metre east of the odometry, also where there is no keyframe.
  const auto states = runPageJson(folder_.path(), {}, &diagnostics_)["states"]["numbers"];
  for (const size_t row : {0u, 7u, 100u, 199u}) {
    EXPECT_NEAR(at(solutions[0], "p_x [m]", row), states["p_x [m]"][row].get<double>() + 0.5, 1e-4) << row;
    EXPECT_NEAR(at(solutions[0], "p_y [m]", row), states["p_y [m]"][row].get<double>(), 1e-4) << row;
    double product = 0.0;  // of the quaternions, whose signs may differ
    for (const char* column : {"q_w", "q_x", "q_y", "q_z"})
      product += at(solutions[0], column, row) * states[column][row].get<double>();
    EXPECT_NEAR(std::abs(product), 1.0, 1e-6) << row;
  }
}

TEST_F(Solutions, BetweenKeyframesThatDisagreeTheCorrectionGoesOverSmoothly) {
  std::string poses = "#t x y z qx qy qz qw\n";
  for (const int t_s : {0, 10}) {
    const double turn = 0.2 * t_s + M_PI / 2.0, radius_m = 2.0 + 0.05 * t_s;
    const double x = radius_m * std::cos(0.2 * t_s) + 0.1 * t_s, y = radius_m * std::sin(0.2 * t_s);
    poses += std::to_string(1700000000 + t_s) + ".000000000 " + std::to_string(x) + " " + std::to_string(y) +
             " " + std::to_string(-0.05 * t_s) + " 0 0 " + std::to_string(std::sin(turn / 2)) + " " +
             std::to_string(std::cos(turn / 2)) + "\n";
  }
  folder_.write("keyframes_map.tum", poses);
  const auto map = others()[0];
  const auto states = runPageJson(folder_.path(), {}, &diagnostics_)["states"]["numbers"];
  const auto shift = [&](size_t row) {
    return at(map, "p_x [m]", row) - states["p_x [m]"][row].get<double>();
  };
  EXPECT_NEAR(shift(0), 0.0, 1e-4);
  EXPECT_NEAR(shift(75), 0.5, 1e-3);   // after 5 s of 10
  EXPECT_NEAR(shift(195), 1.0, 1e-3);  // after the last keyframe
}

TEST_F(Solutions, ARefinedRunKeepsItsCausalPoses) {
  std::filesystem::copy(folder_.path() / "states.csv", folder_.path() / "states_refined.csv");
  const auto solutions = others();
  ASSERT_EQ(solutions.size(), 2u);
  EXPECT_EQ(solutions[0]["kind"], "run");
  EXPECT_TRUE(solutions[0]["states"]["numbers"].contains("sigma_p_x [m]"));
  EXPECT_FALSE(solutions[0]["states"]["numbers"].contains("v_x [m/s]"));
}

TEST_F(Solutions, WithoutAMapThereIsOne) {
  std::filesystem::remove(folder_.path() / "keyframes_map.tum");
  EXPECT_TRUE(others().empty());
  folder_.write("keyframes_map.tum", "");  // of a run that was killed
  EXPECT_TRUE(others().empty());
}

TEST_F(Solutions, KeyframesOfAnotherRunAreNoSolution) {
  folder_.write("keyframes_map.tum", "1600000000.0 0 0 0 0 0 0 1\n1600000001.0 1 0 0 0 0 0 1\n");
  EXPECT_TRUE(others().empty());
}

}  // namespace
}  // namespace lodeline
