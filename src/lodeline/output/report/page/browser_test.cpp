#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

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

/// Stations each four seconds, one of them without a wall to the right.
nlohmann::ordered_json testStations(const std::filesystem::path& /*run*/, int64_t /*origin_ns*/) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const double t_s : {0.0, 4.0, 8.0, 12.0}) {
    nlohmann::json right = 0.9;
    if (t_s == 4.0) right = nullptr;
    json.push_back({{"t_s", t_s},
                    {"left_right_up_down_m", {1.1, right, 0.8, 0.7}},
                    {"splays_m", {{1.0, 0.0, 0.0}, {0.0, 0.0, 0.8}, {-1.1, 0.0, 0.0}, {0.0, 0.0, -0.7}}}});
  }
  return json;
}

/// Red walls beside the way.
void writeTestWalls(const std::filesystem::path& file) {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2000\nproperty float x\nproperty float "
      "y\nproperty float "
      "z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  for (int i = 0; i < 2000; ++i) {
    const float p[3] = {3.0f * std::cos(0.01f * i), 3.0f * std::sin(0.01f * i), 0.001f * (i % 1000)};
    text.append(reinterpret_cast<const char*>(p), sizeof(p)).append("\xc8\x20\x20");
  }
  writeOutput(file, text);
}

TEST_F(Browser, ShowsASurveyOnAnyScreen) {
  test::TestRun run;
  run.picture_width_px = 160;
  const std::filesystem::path dive = folder_.path() / "dive";
  test::writeTestRun(dive, run);
  std::filesystem::copy(dive / "states.csv", dive / "states_refined.csv");
  writeTestWalls(dive / "walls.ply");
  ReportOptions options;
  options.stations = testStations;
  options.background = {{"name", "old survey"}, {"lines", {{{-3, -3}, {3, 3}}}}, {"image", nullptr}};
  Diagnostics diagnostics;
  writeOutput(folder_.path() / "report.html", reportPage({dive}, options, &diagnostics));
  EXPECT_TRUE(passesInBrowser("survey.mjs", folder_.path() / "report.html"));
}

TEST_F(Browser, ComparesTwoRuns) {
  test::writeTestRun(folder_.path() / "first");
  test::TestRun shorter;
  shorter.frames = 120;
  test::writeTestRun(folder_.path() / "second", shorter);
  EXPECT_TRUE(passesInBrowser("two_runs.mjs",
                              pageOf({folder_.path() / "first", folder_.path() / "second"}, std::nullopt)));
}

/// Fifty minutes at 15 Hz.
test::TestRun longDive() {
  test::TestRun dive;
  dive.frames = 50 * 60 * 15;
  dive.landmarks_per_frame = 4;
  dive.pictures = 99;
  dive.picture_width_px = 640;
  return dive;
}

/// Writes a coloured cloud of points spread over 100 m.
void writeCloud(const std::filesystem::path& file, uint32_t points) {
  std::ofstream stream(file, std::ios::binary);
  stream << "ply\nformat binary_little_endian 1.0\nelement vertex " << points
         << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar "
            "green\nproperty uchar blue\nend_header\n";
  std::mt19937 random(1);
  for (uint32_t i = 0; i < points; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const float value_m = 1e-4F * static_cast<float>(random() % 1000000);
      stream.write(reinterpret_cast<const char*>(&value_m), sizeof(value_m));
    }
    const auto colour = static_cast<uint32_t>(random());
    stream.write(reinterpret_cast<const char*>(&colour), 3);
  }
}

TEST_F(Browser, OpensFiftyMinutesFrom15Megabytes) {
  test::writeTestRun(folder_.path() / "dive", longDive());
  const std::filesystem::path page = pageOf({folder_.path() / "dive"}, std::nullopt);
  const auto size = std::filesystem::file_size(page);
  printf("%.1f MB\n", 1e-6 * static_cast<double>(size));
  EXPECT_LE(size, 15'000'000u);
  EXPECT_TRUE(passesInBrowser("opening_time.mjs", page));
}

TEST_F(Browser, OpensThreeLongDivesWithTwoMillionPointsFrom40Megabytes) {
  test::writeTestRun(folder_.path() / "dive0", longDive());
  std::vector<std::filesystem::path> dives;
  for (int i = 0; i < 3; ++i) {
    dives.push_back(folder_.path() / ("dive" + std::to_string(i)));
    if (i > 0)
      std::filesystem::copy(dives[0], dives[static_cast<size_t>(i)],
                            std::filesystem::copy_options::recursive);
  }
  for (const std::filesystem::path& dive : dives) writeCloud(dive / "walls.ply", 667'000);
  const std::filesystem::path page = pageOf(dives, std::nullopt);
  const auto size = std::filesystem::file_size(page);
  printf("%.1f MB\n", 1e-6 * static_cast<double>(size));
  EXPECT_LE(size, 40'000'000u);
  EXPECT_TRUE(passesInBrowser("opening_time.mjs", page));
}

}  // namespace
}  // namespace lodeline
