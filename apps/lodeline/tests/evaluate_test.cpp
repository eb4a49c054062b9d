#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "apps/lodeline/tests/test_program.h"

namespace lodeline::test {
namespace {

namespace fs = std::filesystem;

/// Trajectories in the TUM layout in a folder: a turn of 20 s, and estimates that deviate from it.
class Evaluate : public ::testing::Test {
 protected:
  Evaluate() : folder_(fs::path(::testing::TempDir()) / "evaluate") {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "other");
    write("truth.tum", 0.0);
    write("close.txt", 0.02);
    write("other/close.txt", 0.5);
  }

  /// `wave_m`: amplitude of the deviation along x.
  void write(const std::string& name, double wave_m) const {
    std::ofstream file(folder_ / name);
    for (int i = 0; i <= 400; ++i) {
      const double t = 0.05 * i;
      file << t << ' ' << 5.0 * std::cos(0.3 * t) + wave_m * std::sin(2.0 * t) << ' '
           << 5.0 * std::sin(0.3 * t) << ' ' << 0.1 * t << " 0 0 0 1\n";
    }
  }

  std::string file(const std::string& name) const { return quoted(folder_ / name); }

  fs::path folder_;
};

TEST_F(Evaluate, SeveralEstimatesAreInOneTableWithDistinctNames) {
  const Execution run =
      runProgram("evaluate " + file("close.txt") + " " + file("other/close.txt") + " " + file("truth.tum") +
                 " --json " + file("both.json") + " --html " + file("page.html"));
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_NE(run.output.find("\nclose "), std::string::npos) << run.output;
  EXPECT_NE(run.output.find("\nother_close "), std::string::npos) << run.output;
  const nlohmann::json both = readJson(folder_ / "both.json")["estimates"];
  const double close_m = both["close"]["absolute"]["position_m"]["rmse"];
  const double far_m = both["other_close"]["absolute"]["position_m"]["rmse"];
  EXPECT_NEAR(close_m, 0.02 / std::sqrt(2.0), 0.003);
  EXPECT_NEAR(far_m, 0.5 / std::sqrt(2.0), 0.08);
}

TEST_F(Evaluate, APartIsJudgedAlone) {
  // The estimate is exact up to 10 s, and 1 m off from there on.
  std::istringstream truth(readText(folder_ / "truth.tum"));
  std::ofstream estimate(folder_ / "jump.txt");
  for (std::string line; std::getline(truth, line);) {
    double t = 0.0, x = 0.0, y = 0.0, z = 0.0;
    std::istringstream(line) >> t >> x >> y >> z;
    estimate << t << ' ' << x << ' ' << y << ' ' << (t > 10.01 ? z + 1.0 : z) << " 0 0 0 1\n";
  }
  estimate.close();
  const auto rmse = [&](const std::string& part) {
    const Execution run = runProgram("evaluate " + file("jump.txt") + " " + file("truth.tum") +
                                     " -q --align none --json " + file("part.json") + part);
    EXPECT_EQ(run.exit_code, 0) << run.output;
    return readJson(folder_ / "part.json")["absolute"]["position_m"]["rmse"].get<double>();
  };
  EXPECT_NEAR(rmse(""), std::sqrt(0.5), 0.01);
  EXPECT_NEAR(rmse(" --to 10"), 0.0, 1e-6);
  EXPECT_NEAR(rmse(" --from 11 --to 15"), 1.0, 1e-6);
  const Execution outside =
      runProgram("evaluate " + file("jump.txt") + " " + file("truth.tum") + " --from 100");
  EXPECT_EQ(outside.exit_code, 1);
  EXPECT_NE(outside.output.find("has no pose in the part"), std::string::npos) << outside.output;
}

TEST_F(Evaluate, ThePageShowsTrajectoriesOfOtherPrograms) {
  ASSERT_EQ(runProgram("evaluate " + file("close.txt") + " " + file("other/close.txt") + " " +
                       file("truth.tum") + " --quiet --html " + file("page.html"))
                .exit_code,
            0);
  const std::string page = readText(folder_ / "page.html");
  EXPECT_NE(page.find("other_close"), std::string::npos);
  EXPECT_GT(page.size(), 100'000u) << "scripts and data are in the page";
}

TEST_F(Evaluate, OneTrajectoryIsNotEnough) {
  EXPECT_EQ(runProgram("evaluate " + file("close.txt")).exit_code, 2);
}

TEST_F(Evaluate, QuietPrintsNothing) {
  const Execution run = runProgram("evaluate " + file("close.txt") + " " + file("truth.tum") + " -q");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.output, "");
}

}  // namespace
}  // namespace lodeline::test
