#include "lodeline/evaluation/errors/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/evaluation/figures/comparison_report.h"
#include "lodeline/evaluation/figures/plots.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

namespace lodeline {
namespace {

using testing::HasSubstr;
using testing::Not;

ComparedRun runTurned(double degrees, HeadingBasis basis, const std::string& seed) {
  const Trajectory truth = test::bend(300);
  const Rigid3 turn(Quat(Eigen::AngleAxisd(degrees * M_PI / 180.0, Vec3::UnitZ())), Vec3::Zero());
  Diagnostics diagnostics;
  ComparedRun run;
  run.seed = seed;
  run.errors = computeRunErrors(test::transformed(truth, turn, 1.1), truth, basis, {}, diagnostics);
  run.completion = 1.0;
  run.core_ms_per_frame = 10.0 * degrees;
  return run;
}

ComparedRecording recording() {
  ComparedRecording r;
  r.name = "cave_1";
  r.extent = "in full: 5 m";
  r.methods.push_back(
      {"absolute",
       {runTurned(1.0, HeadingBasis::North, "noise 1"), runTurned(2.0, HeadingBasis::North, "noise 2")}});
  r.methods.push_back({"off", {runTurned(40.0, HeadingBasis::Start, "noise 1"), {}}});
  r.methods.back().runs.back().seed = "noise 2";
  r.methods.back().runs.back().failure = "no pose; waiting for parallax";
  r.methods.back().runs.back().completion = 0.0;
  return r;
}

TEST(Comparison, MeansAreOfRunsWithErrorsAndCompletionOfAll) {
  const ComparedRecording r = recording();
  const MethodMeans absolute = meansOf(r.methods[0]);
  EXPECT_EQ(absolute.runs, 2);
  EXPECT_NEAR(absolute.heading_rmse_deg, 1.5, 1e-9);
  EXPECT_NEAR(absolute.scale, 1.0 / 1.1, 1e-9);
  EXPECT_NEAR(absolute.core_ms_per_frame, 15.0, 1e-9);
  EXPECT_EQ(absolute.basis, HeadingBasis::North);
  const MethodMeans off = meansOf(r.methods[1]);
  EXPECT_EQ(off.runs, 1);
  EXPECT_EQ(off.total_runs, 2);
  EXPECT_NEAR(off.heading_rmse_deg, 0.0, 1e-9);
  EXPECT_NEAR(off.completion, 0.5, 1e-12);
  EXPECT_EQ(baselineOf(r)->name, "off");
}

TEST(Comparison, OneRunWithoutNorthIsNotMixedInUnsaid) {
  ComparedRecording r = recording();
  r.methods[0].runs.push_back(runTurned(5.0, HeadingBasis::Start, "noise 3"));
  EXPECT_EQ(meansOf(r.methods[0]).basis, HeadingBasis::Start);
  EXPECT_THAT(comparisonTable(r), HasSubstr("absolute, noise 3: found no north"));
}

TEST(Comparison, TableHidesNoFailureAndNoMissingImages) {
  ComparedRecording r = recording();
  r.methods[0].runs[1].completion = 0.61;
  for (const std::string& text : {comparisonTable(r), comparisonMarkdown(r)}) {
    EXPECT_THAT(text, HasSubstr("1/2"));
    EXPECT_THAT(text, HasSubstr("off, noise 2: failed: no pose; waiting for parallax"));
    EXPECT_THAT(text, HasSubstr("absolute, noise 2: 61.0 % of the images have a pose"));
    EXPECT_THAT(text, HasSubstr("in full: 5 m"));
  }
  r.methods[1].runs.erase(r.methods[1].runs.begin());
  EXPECT_THAT(comparisonTable(r), HasSubstr("no trajectory"));
  const auto json = comparisonJson(r);
  EXPECT_EQ(json["methods"][1]["runs"][0]["failure"], "no pose; waiting for parallax");
  EXPECT_NEAR(json["methods"][0]["mean"]["against_world"]["heading_rmse_deg"].get<double>(), 1.5, 1e-9);
}

TEST(Comparison, FiguresAreDrawn) {
  const test::TemporaryFolder folder;
  Diagnostics diagnostics;
  const ComparedRecording r = recording();
  drawFigures({trajectoriesFigure(r), relativeYawFigure(r)}, folder.path(), diagnostics);
  if (diagnostics.count("gnuplot_missing") > 0) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_TRUE(diagnostics.ranked().empty()) << diagnostics.ranked().front().first_message;
  for (const char* name : {"cave_1_trajectories.png", "cave_1_relative_yaw.svg"}) {
    EXPECT_GT(std::filesystem::file_size(folder.path() / name), 5000u) << name;
  }
}

}  // namespace
}  // namespace lodeline
