#include "lodeline/output/report/page/report_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/output/report/page/page_template.h"
#include "lodeline/output/report/page/run_page.h"
#include "lodeline/output/report/page/table_json.h"
#include "lodeline/output/report/page/test_run.h"

namespace lodeline {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

TEST(ShortNumber, KeepsSixDigitsAndSaysWhatIsNotANumber) {
  EXPECT_EQ(shortNumber(0.123456789).dump(), "0.123457");
  EXPECT_EQ(shortNumber(-1234567.0).get<double>(), -1234570.0);
  EXPECT_EQ(shortNumber(4.5e-8).dump(), "4.5e-08");
  EXPECT_EQ(shortNumber(0.0).dump(), "0");
  EXPECT_EQ(shortNumber(std::nan("")).dump(), "null");
}

TEST(RunPage, HoldsWhatTheFilesOfTheRunSay) {
  const TemporaryFolder folder;
  test::writeTestRun(folder.path() / "dive");
  Diagnostics diagnostics;
  const auto run = runPageJson(folder.path() / "dive", {}, &diagnostics);
  EXPECT_EQ(run["name"], "dive");
  EXPECT_EQ(run["origin_ns"], "1700000000000000000");
  const auto& states = run["states"];
  EXPECT_EQ(states["total"], 200);
  EXPECT_EQ(states["t_s"].size(), 200u);
  EXPECT_EQ(states["t_s"][15], 1.0);
  EXPECT_EQ(states["words"]["status"][49], "inertial");
  EXPECT_EQ(states["words"]["magnetometer"][19], "norm");
  EXPECT_NEAR(states["numbers"]["p_z [m]"][30].get<double>(), -0.1, 1e-9);
  EXPECT_NEAR(states["numbers"]["cov_pose_00"][15].get<double>(), 2e-4, 1e-9);
  EXPECT_FALSE(states["numbers"].contains("cov_pose_33"));
  EXPECT_EQ(run["landmarks"]["total"], 1000);
  EXPECT_EQ(run["landmarks"]["xyz"].get<std::string>().size(), 8000u);  // 6 bytes a point
  EXPECT_EQ(run["pictures"].size(), 6u);
  EXPECT_NEAR(run["pictures"][1]["t_s"].get<double>(), 200.0 / 15.0 / 6.0, 1e-3);
  EXPECT_EQ(run["timings"]["numbers"]["estimator [s]"][3], 0.011);
  EXPECT_TRUE(run["magnetometer"]["is_calibrated"]);
  EXPECT_NEAR(run["magnetometer"]["field_strength_T"].get<double>(), 45.532e-6, 1e-9);
  EXPECT_TRUE(run["evaluation"].is_null());
}

TEST(RunPage, TurnsTheCloudOfLodelineWallsBackToTheWorldOfTheRun) {
  const TemporaryFolder folder;
  const auto dive = folder.path() / "dive";
  test::writeTestRun(dive);
  const auto walls = [&] {
    Diagnostics diagnostics;
    return runPageJson(dive, {}, &diagnostics)["walls"];
  };
  EXPECT_TRUE(walls().is_null());
  std::filesystem::create_directories(dive / "walls");
  const auto writeCloud = [](const std::filesystem::path& file) {
    std::ofstream stream(file, std::ios::binary);
    stream << "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
              "property float z\nend_header\n";
    const float values[] = {1.0F, 10.0F, -2.0F, 3.0F, 40.0F, 5.0F};
    stream.write(reinterpret_cast<const char*>(values), sizeof(values));
  };
  writeCloud(dive / "walls" / "cloud.ply");
  // A quarter turn to the right made north; a point in the north was in the west of the run's world.
  std::ofstream(dive / "walls" / "walls.json") << R"({"turn_rad": 1.5707963267948966})";
  EXPECT_NEAR(walls()["low_m"][0].get<double>(), -40.0, 1e-5);
  EXPECT_NEAR(walls()["low_m"][1].get<double>(), 1.0, 1e-5);
  EXPECT_NEAR(walls()["low_m"][2].get<double>(), -2.0, 1e-5);
  writeCloud(dive / "walls.ply");  // goes first, as it is
  EXPECT_NEAR(walls()["low_m"][0].get<double>(), 1.0, 1e-5);
}

TEST(RunPage, HoldsLoopsLedgerAndControl) {
  const TemporaryFolder folder;
  test::writeTestRun(folder.path() / "dive");
  Diagnostics diagnostics;
  const auto map = runPageJson(folder.path() / "dive", {}, &diagnostics)["map"];
  EXPECT_EQ(map["pairs"], 5);
  ASSERT_EQ(map["loops"].size(), 2u);
  EXPECT_EQ(map["loops"][0]["new_t_s"], 10.0);
  EXPECT_EQ(map["loops"][0]["old_t_s"], 2.0);
  ASSERT_EQ(map["outcomes"].size(), 3u);
  for (const auto& outcome : map["outcomes"]) {
    const std::string reason = outcome["reason"];
    if (outcome["status"] == "candidate") {
      EXPECT_EQ(reason, "… matches, … needed");
    }
    if (outcome["status"] == "refused") {
      EXPECT_EQ(reason, "tag 7 hangs 3.20 m away");
    }
    EXPECT_EQ(outcome["count"], outcome["t_s"].size());
  }
  ASSERT_EQ(map["path"]["t_s"].size(), 14u);
  EXPECT_NEAR(map["path"]["x"][0].get<double>(), 2.5, 1e-6);
  ASSERT_EQ(map["control"].size(), 2u);
  EXPECT_EQ(map["control"][1]["name"], "tag 7, old");
  EXPECT_EQ(map["control"][1]["error_m"][0], 3.2);
  EXPECT_TRUE(map["control"][1]["is_blunder"]);
  EXPECT_EQ(diagnostics.count("run_file_cut_off"), 0);
}

TEST(RunPage, LeavesOutThePathInTheFrameOfAnotherDive) {
  const TemporaryFolder folder;
  test::TestRun run;
  run.old_dive = "other";
  test::writeTestRun(folder.path() / "dive", run);
  Diagnostics diagnostics;
  const auto map = runPageJson(folder.path() / "dive", {}, &diagnostics)["map"];
  EXPECT_TRUE(map["loops"][1]["old_t_s"].is_null());
  EXPECT_EQ(map["loops"][1]["old_dive"], "other");
  EXPECT_TRUE(map["path"].is_null());
}

TEST(RunPage, HasNoMapWhereMappingWasOff) {
  const TemporaryFolder folder;
  test::TestRun run;
  run.map = false;
  test::writeTestRun(folder.path() / "dive", run);
  Diagnostics diagnostics;
  EXPECT_TRUE(runPageJson(folder.path() / "dive", {}, &diagnostics)["map"].is_null());
}

TEST(RunPage, NamesABadLineOfTheLedger) {
  const TemporaryFolder folder;
  const std::filesystem::path dive = folder.path() / "dive";
  test::writeTestRun(dive);
  std::ifstream stream(dive / "loops.csv");
  const std::string good((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  Diagnostics diagnostics;
  // An incomplete last line of a run that was killed.
  std::ofstream(dive / "loops.csv") << good << "17000,5";
  EXPECT_EQ(runPageJson(dive, {}, &diagnostics)["map"]["pairs"], 5);
  EXPECT_EQ(diagnostics.count("run_file_cut_off"), 1);
  std::ofstream(dive / "loops.csv") << good << "17000,5\n" << good.substr(good.find('\n') + 1);
  EXPECT_THROW(runPageJson(dive, {}, &diagnostics), InputError);
  std::string wrong = good;
  wrong.replace(wrong.find("17000000", wrong.find('\n')), 4, "when");
  std::ofstream(dive / "loops.csv") << wrong;
  EXPECT_THROW(runPageJson(dive, {}, &diagnostics), InputError);
}

TEST(RunPage, ShowsTheRefinedResultFirst) {
  const TemporaryFolder folder;
  const std::filesystem::path dive = folder.path() / "dive";
  test::writeTestRun(dive);
  Diagnostics diagnostics;
  EXPECT_FALSE(runPageJson(dive, {}, &diagnostics)["is_refined"].get<bool>());
  test::writeTestRun(folder.path() / "short", {.frames = 150});
  std::filesystem::copy(folder.path() / "short" / "states.csv", dive / "states_refined.csv");
  std::filesystem::copy(folder.path() / "short" / "landmarks.ply", dive / "landmarks_refined.ply");
  const auto refined = runPageJson(dive, {}, &diagnostics);
  EXPECT_TRUE(refined["is_refined"].get<bool>());
  EXPECT_EQ(refined["states"]["total"], 150);
  EXPECT_EQ(refined["landmarks"]["total"], 750);
}

// The magnetometer was calibrated at another place.
TEST(RunPage, TakesTheSphereFromTheRunsOwnField) {
  const TemporaryFolder folder;
  test::writeTestRun(folder.path() / "dive");
  const std::filesystem::path file = folder.path() / "dive" / "run.json";
  Diagnostics diagnostics;
  const auto sphere = [&](const std::function<void(nlohmann::json*)>& change) {
    nlohmann::json summary = nlohmann::json::parse(std::ifstream(file));
    change(&summary);
    std::ofstream(file) << summary;
    const auto page = runPageJson(folder.path() / "dive", {}, &diagnostics)["magnetometer"];
    return std::pair(page["field_strength_from"].get<std::string>(), page["field_strength_T"].get<double>());
  };
  EXPECT_EQ(sphere([](nlohmann::json*) {}).first, "the field at the site");
  const auto estimated = sphere([](nlohmann::json* summary) {
    (*summary)["rig"]["magnetometer"].erase("site_field_strength_T");
    (*summary)["magnetometer"]["field_W_T"] = {0.0, 3e-5, -4e-5};
  });
  EXPECT_EQ(estimated.first, "the field as estimated");
  EXPECT_NEAR(estimated.second, 50e-6, 1e-12);
  const auto calibrated =
      sphere([](nlohmann::json* summary) { (*summary)["magnetometer"].erase("field_W_T"); });
  EXPECT_EQ(calibrated.first, "the field where it was calibrated");
  EXPECT_NEAR(calibrated.second, 50e-6, 1e-12);
}

TEST(RunPage, ComparesWithAReference) {
  const TemporaryFolder folder;
  test::writeTestRun(folder.path() / "dive");
  test::writeTestReference(folder.path() / "truth.tum");
  Diagnostics diagnostics;
  const ReportReference reference = {folder.path() / "truth.tum", AlignmentType::None};
  const auto run = runPageJson(folder.path() / "dive", {reference}, &diagnostics);
  const auto& evaluation = run["evaluation"];
  EXPECT_NEAR(evaluation["figures"]["absolute"]["position_m"]["rmse"].get<double>(), 0.1, 1e-6);
  EXPECT_NEAR(evaluation["errors"]["numbers"]["position [m]"][5].get<double>(), 0.1, 1e-6);
  EXPECT_GT(evaluation["path"]["x"].size(), 100u);
  EXPECT_TRUE(evaluation["yaw_aligned"].is_null());
}

TEST(RunPage, TellsErrorsOfAttitudeAfterTurningAboutTheVertical) {
  const TemporaryFolder folder;
  test::writeTestRun(folder.path() / "dive");
  test::writeTestReference(folder.path() / "truth.tum");
  Diagnostics diagnostics;
  const ReportReference reference = {folder.path() / "truth.tum", AlignmentType::SE3};
  const auto evaluation = runPageJson(folder.path() / "dive", {reference}, &diagnostics)["evaluation"];
  EXPECT_EQ(evaluation["figures"]["alignment"]["type"], "se3");
  EXPECT_NEAR(evaluation["yaw_aligned"]["position_m"]["rmse"].get<double>(), 0.0, 1e-6);
  EXPECT_NEAR(evaluation["yaw_aligned"]["rotation_deg"]["rmse"].get<double>(), 0.0, 1e-5);
}

TEST(RunPage, LongRunsAreThinnedAndKeepEveryChangeOfStatus) {
  const TemporaryFolder folder;
  test::TestRun long_run;
  long_run.frames = 20000;
  test::writeTestRun(folder.path(), long_run);
  Diagnostics diagnostics;
  const auto states = runPageJson(folder.path(), {}, &diagnostics)["states"];
  EXPECT_EQ(states["total"], 20000);
  EXPECT_EQ(states["stride"], 3);
  EXPECT_LT(states["t_s"].size(), 2 * kMostRows);
  EXPECT_EQ(std::count(states["words"]["status"].begin(), states["words"]["status"].end(), "inertial"), 400);
}

TEST(RunPage, DoesWithoutWhatARunLacks) {
  const TemporaryFolder folder;
  test::writeTestRun(folder.path());
  for (const char* file : {"run.json", "config.yaml", "landmarks.ply", "timings.csv", "magnetometer.csv"}) {
    std::filesystem::remove(folder.path() / file);
  }
  std::filesystem::remove_all(folder.path() / "pictures");
  Diagnostics diagnostics;
  const auto run = runPageJson(folder.path(), {}, &diagnostics);
  EXPECT_EQ(run["states"]["total"], 200);
  EXPECT_TRUE(run["timings"].is_null());
  EXPECT_TRUE(run["magnetometer"].is_null());
  EXPECT_TRUE(run["pictures"].empty());
}

TEST(RunPage, LastLineThatWasCutOffIsPassedOver) {
  const TemporaryFolder folder;
  test::writeTestRun(folder.path());
  std::ofstream(folder.path() / "states.csv", std::ios::app) << "1700000099000000000,tracking,0,1";
  Diagnostics diagnostics;
  EXPECT_EQ(runPageJson(folder.path(), {}, &diagnostics)["states"]["total"], 200);
  EXPECT_EQ(diagnostics.count("run_file_cut_off"), 1);
}

TEST(RunPage, DamageIsNamedWithFileAndLine) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  EXPECT_THROW(runPageJson(folder.path(), {}, &diagnostics), InputError);
  folder.write("states.csv", "#timestamp [ns],status\n1,tracking\nx,tracking\n3,tracking\n");
  try {
    runPageJson(folder.path(), {}, &diagnostics);
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("states.csv:3"));
  }
}

TEST(ReportPage, NothingInTheDataEndsTheScript) {
  if (pageTemplate().empty()) GTEST_SKIP() << "built without the report page";
  const TemporaryFolder folder;
  test::writeTestRun(folder.path());
  Diagnostics diagnostics;
  const std::string page = reportPage({folder.path()}, {}, &diagnostics);
  EXPECT_THAT(page, HasSubstr("a name with \\u003c/script> in it"));
  EXPECT_THAT(page, Not(HasSubstr("with </script>")));
  EXPECT_THAT(page, Not(HasSubstr("LODELINE_DATA")));
}

TEST(ReportPage, SaysHowMuchOfEachRunIsDone) {
  if (pageTemplate().empty()) GTEST_SKIP() << "built without the report page";
  const TemporaryFolder folder;
  test::writeTestRun(folder.path());
  Diagnostics diagnostics;
  std::vector<double> shares;
  ReportOptions options;
  options.progress = [&](double share) { shares.push_back(share); };
  reportPage({folder.path(), folder.path()}, options, &diagnostics);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.front(), 0.0);
  EXPECT_EQ(shares.back(), 1.0);
  EXPECT_GE(std::count_if(shares.begin(), shares.end(), [](double share) { return share < 0.5; }), 5);
}

TEST(ReportPage, AsksForNothingFromTheNetwork) {
  if (pageTemplate().empty()) GTEST_SKIP() << "built without the report page";
  EXPECT_EQ(pageTemplate().find("<script src"), std::string_view::npos);
  EXPECT_EQ(pageTemplate().find("<link rel=\"stylesheet\""), std::string_view::npos);
  EXPECT_EQ(pageTemplate().find("@import"), std::string_view::npos);
}

}  // namespace
}  // namespace lodeline
