#include <fstream>

#include "apps/lodeline/tests/test_magnetic_room.h"
#include "lodeline/trajectory.h"

// Tests of `lodeline compare` as a program.

namespace lodeline::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

class Compare : public MagneticRoomTest {
 protected:
  Compare() {
    fs::create_directories(recording_.sensor("state_groundtruth_estimate0"));
    fs::copy_file(recording_.truth, recording_.sensor("state_groundtruth_estimate0") / "gt_tum.txt");
  }

  Execution compare(const std::string& what, const std::string& options) const {
    return runProgram(fmt::format("compare {} -o {} --quiet {}", what, quoted(output_), options));
  }
  Execution compareRoom(const std::string& options) const {
    return compare(quoted(recording_.data), "--mag-calibration " + quoted(calibration_) + " " + options);
  }

  nlohmann::json recording() const { return readJson(output_ / "compare.json")["recordings"][0]; }
  /// Folder of a run on the room; `number` follows its name where recordings have the same name.
  fs::path run(const std::string& method, const std::string& number = "") const {
    return output_ / "results" /
           fmt::format("{}{}.{}.features_1", recording_.data.filename().string(), number, method);
  }
};

TEST_F(Compare, JudgesMethodsAndMakesNoRunTwice) {
  const std::string options = "--methods off,absolute,azimuth --runs 1";
  const Execution first = compareRoom(options);
  ASSERT_EQ(first.exit_code, 0) << first.output;
  const nlohmann::json methods = recording()["methods"];
  ASSERT_EQ(methods.size(), 3u);
  EXPECT_EQ(methods[0]["mean"]["against_world"]["heading_from"], "start");
  for (int i = 0; i < 3; ++i) {
    const nlohmann::json& mean = methods[i]["mean"];
    EXPECT_EQ(mean["completion_percent"], 100.0) << i;
    EXPECT_LT(mean["after_sim3"]["position_rmse_m"].get<double>(), 0.01) << i;
    EXPECT_LT(mean["against_world"]["heading_rmse_deg"].get<double>(), 2.0) << i;
    if (i > 0) {
      EXPECT_EQ(mean["against_world"]["heading_from"], "north") << i;
    }
  }
  EXPECT_THAT(first.output, HasSubstr("in full"));
  EXPECT_THAT(readText(output_ / "compare.md"), HasSubstr("| `azimuth` | 1/1 |"));

  EXPECT_TRUE(fs::exists(run("azimuth") / "trajectory.tum"));
  const fs::path states = run("off") / "states.csv";
  const auto written = fs::last_write_time(states);
  const Execution again = compareRoom(options);
  EXPECT_EQ(again.output, first.output);
  EXPECT_EQ(fs::last_write_time(states), written);
  // A result is complete with its item.json, which is written last.
  std::ofstream(run("off") / "item.json") << "{\"key\": 1";
  EXPECT_EQ(compareRoom(options).exit_code, 0);
  const auto rewritten = fs::last_write_time(states);
  EXPECT_NE(rewritten, written);
  // Another setting gives another run.
  compareRoom("--methods off --runs 1 --set front_end.max_tracks=90");
  EXPECT_NE(fs::last_write_time(states), rewritten);
}

TEST_F(Compare, SaysSoWhereARunFailsAndWhereImagesAreMissing) {
  for (int camera = 0; camera < 2; ++camera) {
    for (size_t i = 20; i < recording_.image_names.size(); ++i) fs::remove(recording_.image(camera, i));
  }
  const Execution part = compareRoom("--methods off --runs 1");
  ASSERT_EQ(part.exit_code, 0) << part.output;
  EXPECT_THAT(part.output, HasSubstr("an excerpt"));
  EXPECT_THAT(part.output, HasSubstr("the rest has no images"));
  EXPECT_EQ(recording()["methods"][0]["mean"]["completion_percent"], 100.0);

  for (int camera = 0; camera < 2; ++camera) {
    for (size_t i = 0; i < 20; ++i) writeBlankImage(recording_.image(camera, i));
  }
  fs::remove_all(output_);
  const Execution blank = compareRoom("--methods off --runs 1");
  EXPECT_EQ(blank.exit_code, 3) << blank.output;
  EXPECT_THAT(blank.output, HasSubstr("no trajectory"));
  EXPECT_THAT(blank.output, HasSubstr("off, features 1: failed: no pose after"));
}

TEST_F(Compare, ScenarioRunsDifferByNoiseAlone) {
  const std::string options =
      "--realism field --seconds 14 --metres 1.2 --width 96 --camera-rate-hz 2 --runs 2 --methods off";
  const Execution result = compare("demo", options);
  // Images of this size may or may not give a trajectory; the comparison exists in both cases.
  ASSERT_THAT(result.exit_code, ::testing::AnyOf(0, 3)) << result.output;
  EXPECT_THAT(result.output, HasSubstr("simulated, field, seed 1: in full"));
  const fs::path first = output_ / "recordings" / "demo_field" / "mav0";
  const fs::path second = output_ / "recordings" / "demo_field_noise2" / "mav0";
  EXPECT_TRUE(fs::is_symlink(second / "cam1" / "data"));
  EXPECT_EQ(fs::canonical(second / "cam1" / "data"), fs::canonical(first / "cam1" / "data"));
  EXPECT_EQ(readText(first / "cam0" / "sensor.yaml"), readText(second / "cam0" / "sensor.yaml"));
  EXPECT_NE(readText(first / "imu0" / "data.csv"), readText(second / "imu0" / "data.csv"));
  EXPECT_NE(readText(first / "mag0" / "data.csv"), readText(second / "mag0" / "data.csv"));
  EXPECT_EQ(recording()["methods"][0]["runs"].size(), 2u);
  EXPECT_TRUE(fs::exists(output_ / "demo_field" / "mag.yaml"));
  const auto written = fs::last_write_time(second / "imu0" / "data.csv");
  compare("demo", options);
  EXPECT_EQ(fs::last_write_time(second / "imu0" / "data.csv"), written);
  const Execution other = compare("demo", "--no-rendering --runs 1");
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.output, HasSubstr("holds no recording of this scenario"));
}

TEST_F(Compare, WrongWordsAndMissingTruthAreNamed) {
  const auto expectError = [&](const Execution& result, int exit_code, const char* says) {
    EXPECT_EQ(result.exit_code, exit_code) << result.output;
    EXPECT_THAT(result.output, HasSubstr(says));
  };
  expectError(compareRoom("--methods off,best"), 2, "no such method");
  expectError(compareRoom("--runs 0"), 2, "--runs");
  expectError(compareRoom("--site 29.83,-82.60,0"), 2, "--date");
  expectError(compare("cave9", ""), 2, "neither a folder, a bag nor a scenario");
  expectError(compare("figure_eight", ""), 2, "without images");
  fs::remove_all(recording_.sensor("state_groundtruth_estimate0"));
  expectError(compareRoom("--runs 1"), 1, "ground truth");
}

TEST_F(Compare, RecordingsOfOneNameAreKeptApart) {
  const std::string data = quoted(recording_.data);
  const Execution result = compare(data + " " + data, "--methods off --runs 1 --set source.duration_s=0.4");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_TRUE(fs::exists(run("off") / "trajectory.tum"));
  EXPECT_TRUE(fs::exists(run("off", "_2") / "trajectory.tum"));
  EXPECT_EQ(readJson(output_ / "compare.json")["recordings"].size(), 2u);
}

TEST_F(Compare, TakesABagWithItsTruth) {
  Diagnostics diagnostics;
  std::string truth = "#timestamp,x,y,z,qw,qx,qy,qz\n";
  for (const StampedPose& pose : readTrajectory(recording_.truth, {}, diagnostics).poses) {
    const Vec3& p = pose.world_from_body.translation;
    const Quat& q = pose.world_from_body.rotation;
    truth += fmt::format("{},{},{},{},{},{},{},{}\n", pose.time.nanoseconds(), p.x(), p.y(), p.z(), q.w(),
                         q.x(), q.y(), q.z());
  }
  fs::remove(recording_.sensor("state_groundtruth_estimate0") / "gt_tum.txt");
  std::ofstream(recording_.sensor("state_groundtruth_estimate0") / "data.csv") << truth;
  const fs::path bag = folder_.path() / "walk.bag";
  const Execution converted = runProgram(fmt::format("convert {} {}", quoted(recording_.data), quoted(bag)));
  if (converted.exit_code == 2) GTEST_SKIP() << converted.output;  // built without librosbag-storage
  ASSERT_EQ(converted.exit_code, 0) << converted.output;
  const Execution result = compare(quoted(bag), "--methods off --runs 1");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(recording()["methods"][0]["mean"]["completion_percent"], 100.0);
  EXPECT_LT(recording()["methods"][0]["mean"]["after_sim3"]["position_rmse_m"].get<double>(), 0.01);
  EXPECT_TRUE(fs::exists(output_ / "recordings" / "walk_from_bag" / "mav0" / "cam0"));
}

TEST_F(Compare, AzimuthWithoutCalibrationSaysWhatItTakes) {
  const Execution result = compare(quoted(recording_.data), "--methods azimuth --runs 1");
  EXPECT_THAT(result.output, HasSubstr("calibrated magnetometer"));
}

}  // namespace
}  // namespace lodeline::test
