#include "lodeline/evaluation/figures/plots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/figures/evaluation_report.h"
#include "lodeline/evaluation/figures/gnuplot.h"
#include "lodeline/evaluation/figures/several_estimates.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

namespace lodeline {
namespace {

Evaluation evaluation() {
  const Trajectory truth = test::bend(200);
  Diagnostics diagnostics;
  EvaluationOptions options;
  options.alignment = AlignmentType::Sim3;
  return evaluate(test::transformed(truth, Rigid3(Quat::Identity(), Vec3(1, 2, 3)), 1.25), truth, options,
                  diagnostics);
}

/// Restores the environment's PATH in the destructor.
class EmptyPath {
 public:
  EmptyPath() : path_(std::getenv("PATH")) { setenv("PATH", "/nonexistent", 1); }
  ~EmptyPath() { setenv("PATH", path_.c_str(), 1); }

 private:
  std::string path_;
};

TEST(Plots, AreWrittenAsSvgAndPng) {
  const test::TemporaryFolder folder;
  Diagnostics diagnostics;
  writePlots(evaluation(), folder.path() / "new" / "it's plots", diagnostics);
  if (diagnostics.count("gnuplot_missing") > 0) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_EQ(diagnostics.count("gnuplot_failed"), 0);
  for (const char* name : {"top_view", "side_view", "error_over_time", "relative_error_over_distance"}) {
    for (const char* ending : {".svg", ".png"}) {
      const auto file = folder.path() / "new" / "it's plots" / (std::string(name) + ending);
      ASSERT_TRUE(std::filesystem::exists(file)) << file;
      EXPECT_GT(std::filesystem::file_size(file), 5000u) << file;
    }
  }
}

TEST(Plots, OfASinglePairAreDrawnToo) {
  const test::TemporaryFolder folder;
  Diagnostics diagnostics;
  writePlots(evaluate(test::bend(1), test::bend(1), {}, diagnostics), folder.path(), diagnostics);
  EXPECT_EQ(diagnostics.count("gnuplot_failed"), 0);
}

TEST(Plots, WithoutGnuplotAreAWarning) {
  const test::TemporaryFolder folder;
  const EmptyPath no_programs;
  Diagnostics diagnostics;
  writePlots(evaluation(), folder.path(), diagnostics);
  EXPECT_EQ(diagnostics.count("gnuplot_missing"), 1);
}

TEST(Plots, NeedAFolder) {
  const test::TemporaryFolder folder;
  Diagnostics diagnostics;
  EXPECT_THROW(writePlots(evaluation(), folder.write("file", ""), diagnostics), InputError);
}

TEST(Gnuplot, ThinsLongCurvesButKeepsTheirEndAndTheirBreaks) {
  gnuplot::Curve curve;
  for (int i = 0; i < 100001; ++i) curve.points.push_back({static_cast<double>(i), 0.0, i == 50001});
  const std::string block = gnuplot::dataBlock("c", curve);
  EXPECT_LT(std::count(block.begin(), block.end(), '\n'), 4100);
  EXPECT_THAT(block, testing::HasSubstr("100000 0"));
  EXPECT_THAT(block, testing::HasSubstr("\n\n"));
}

TEST(Report, TableNamesTheFiguresWithTheirUnits) {
  const std::string table = evaluationTable(evaluation());
  for (const char* part : {"position (m)", "rotation (deg)", "yaw (deg)", "25.00 % too large", "end point",
                           "completion  100.00 %"}) {
    EXPECT_THAT(table, testing::HasSubstr(part));
  }
}

TEST(Report, SeveralEstimatesHaveOneRowEach) {
  Evaluation other = evaluation();
  other.end_point_m = 7.25;
  const std::vector<NamedEvaluation> both = {{"first", evaluation()}, {"it's second", other}};
  const std::string table = severalTable(both);
  EXPECT_THAT(table, testing::HasSubstr("\nfirst "));
  EXPECT_THAT(table, testing::ContainsRegex("it's second .* 7.2500\n"));
  for (const gnuplot::Figure& figure : {severalErrorsFigure(both), severalPathsFigure(both)}) {
    EXPECT_THAT(figure.commands, testing::HasSubstr("$estimate1 << EOD"));
    EXPECT_THAT(figure.commands, testing::HasSubstr("title 'it''s second'"));
  }
}

TEST(Report, JsonHoldsTheFigures) {
  const Evaluation e = evaluation();
  const auto json = evaluationJson(e, {});
  EXPECT_NEAR(json["alignment"]["scale_error_percent"].get<double>(), 25.0, 1e-9);
  EXPECT_LT(json["absolute"]["position_m"]["rmse"].get<double>(), 1e-9);
  EXPECT_EQ(json["relative"].size(), e.relative.size());
  EXPECT_EQ(json["completion"]["percent"].get<double>(), 100.0);
}

}  // namespace
}  // namespace lodeline
