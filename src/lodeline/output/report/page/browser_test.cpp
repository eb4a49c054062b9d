#include <gtest/gtest.h>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/output/report/page/report_page.h"
#include "lodeline/output/report/page/test_browser.h"
#include "lodeline/output/report/page/test_run.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

using test::passesInBrowser;
using test::TemporaryFolder;

class Browser : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = test::browserMissing(); !missing.empty()) GTEST_SKIP() << missing;
  }
  std::filesystem::path pageOf(const std::vector<std::filesystem::path>& runs,
                               const std::optional<ReportReference>& reference) const {
    Diagnostics diagnostics;
    const std::filesystem::path file = folder_.path() / "report.html";
    writeOutput(file, reportPage(runs, {reference}, &diagnostics));
    return file;
  }
  TemporaryFolder folder_;
};

TEST_F(Browser, ShowsARunAndAnswersClicks) {
  test::TestRun run;
  run.picture_width_px = 320;
  test::writeTestRun(folder_.path() / "dive", run);
  test::writeTestReference(folder_.path() / "truth.tum", run);
  const ReportReference reference = {folder_.path() / "truth.tum", AlignmentType::None};
  EXPECT_TRUE(passesInBrowser("one_run.mjs", pageOf({folder_.path() / "dive"}, reference)));
}

TEST_F(Browser, PrintsWholeAndIsReadableOnAPhone) {
  test::TestRun run;
  test::writeTestRun(folder_.path() / "dive", run);
  test::writeTestReference(folder_.path() / "truth.tum", run);
  const ReportReference reference = {folder_.path() / "truth.tum", AlignmentType::SE3};
  EXPECT_TRUE(passesInBrowser("print_and_phone.mjs", pageOf({folder_.path() / "dive"}, reference)));
}

TEST_F(Browser, ComparesTwoRuns) {
  test::writeTestRun(folder_.path() / "first");
  test::TestRun shorter;
  shorter.frames = 120;
  test::writeTestRun(folder_.path() / "second", shorter);
  EXPECT_TRUE(passesInBrowser("two_runs.mjs",
                              pageOf({folder_.path() / "first", folder_.path() / "second"}, std::nullopt)));
}

TEST_F(Browser, OpensFiftyMinutesFrom15Megabytes) {
  test::TestRun dive;
  dive.frames = 50 * 60 * 15;
  dive.landmarks_per_frame = 4;
  dive.pictures = 99;
  dive.picture_width_px = 640;
  test::writeTestRun(folder_.path() / "dive", dive);
  const std::filesystem::path page = pageOf({folder_.path() / "dive"}, std::nullopt);
  const auto size = std::filesystem::file_size(page);
  printf("%.1f MB\n", 1e-6 * static_cast<double>(size));
  EXPECT_LE(size, 15'000'000u);
  EXPECT_TRUE(passesInBrowser("opening_time.mjs", page));
}

}  // namespace
}  // namespace lodeline
