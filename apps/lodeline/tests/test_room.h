#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "apps/lodeline/tests/test_program.h"
#include "apps/lodeline/tests/test_recording.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

namespace lodeline::test {

/// Tests that run the program on a room recording after some modification.
class RoomTest : public testing::Test {
 protected:
  RoomTest() : recording_(writeRoomRecording(folder_.path())), output_(folder_.path() / "out") {}

  Execution run(const std::string& options = "") const {
    return runProgram(
        fmt::format("run {} -o {} --overwrite {}", quoted(recording_.data), quoted(output_), options));
  }

  nlohmann::json summary() const { return readJson(output_ / "run.json"); }

  /// Number of findings of one kind in run.json.
  int findings(const std::string& kind) const {
    const nlohmann::json json = summary();
    int count = 0;
    for (const auto& finding : json["findings"]) {
      if (finding["kind"] == kind) count += finding["count"].get<int>();
    }
    return count;
  }

  int poses() const {
    const std::string text = readText(output_ / "trajectory.tum");
    return static_cast<int>(std::count(text.begin(), text.end(), '\n')) - 1;
  }

  /// RMSE of the position after SE(3) alignment with the truth, m.
  double error_m() const {
    return evaluateRun(output_, recording_.truth, "")["absolute"]["position_m"]["rmse"];
  }

  /// Expects a good result from (almost) all images: complete, and as accurate as that of the unmodified
  /// recording.
  void expectGoodResult(const Execution& result, int expected_poses = kRoomImages) const {
    ASSERT_EQ(result.exit_code, 0) << result.output;
    EXPECT_EQ(poses(), expected_poses);
    EXPECT_LT(error_m(), 0.01);
  }

  TemporaryFolder folder_;
  RoomRecording recording_;
  std::filesystem::path output_;
};

}  // namespace lodeline::test
