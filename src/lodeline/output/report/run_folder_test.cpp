#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "lodeline/diagnostics.h"
#include "lodeline/output/files/landmark_writer.h"
#include "lodeline/output/files/state_writer.h"
#include "lodeline/output/report/run_summary.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

class RunFolder : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("lodeline_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string read(const char* name) const {
    std::ifstream stream(folder_ / name, std::ios::binary);
    std::stringstream text;
    text << stream.rdbuf();
    return text.str();
  }
  std::filesystem::path folder_;
};

FrameEstimate estimateAt(int64_t ns, const Vec3& position) {
  FrameEstimate estimate;
  estimate.time = Time::fromNanoseconds(ns);
  estimate.status = Status::Tracking;
  estimate.state.world_from_body.translation = position;
  estimate.state.world_from_body.rotation = Quat(-0.5, 0.5, 0.5, 0.5);
  estimate.covariance.diagonal().setConstant(0.04);
  return estimate;
}

TEST_F(RunFolder, TrajectoryKeepsEveryNanosecondAndFlushesEachFrame) {
  StateWriter writer(folder_);
  writer.write(estimateAt(1403636584763555584, Vec3(1, -2, 0.25)));
  EXPECT_EQ(
      read("trajectory.tum"),
      "# timestamp [s] x y z qx qy qz qw\n"
      "1403636584.763555584 1.000000000 -2.000000000 0.250000000 -0.500000000 -0.500000000 -0.500000000 "
      "0.500000000\n");
}

TEST_F(RunFolder, StatesHaveAsManyValuesAsNames) {
  StateWriter writer(folder_);
  writer.write(estimateAt(5, Vec3::Zero()));
  std::istringstream states(read("states.csv"));
  std::string header;
  std::string row;
  std::getline(states, header);
  std::getline(states, row);
  EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(row.begin(), row.end(), ','));
  EXPECT_NE(row.find("5,tracking,"), std::string::npos);
  EXPECT_NE(row.find(",0.2,"), std::string::npos);  // sigma = sqrt(0.04)
}

TEST_F(RunFolder, StatesEndWithTheMagnetometer) {
  StateWriter writer(folder_);
  FrameEstimate estimate = estimateAt(5, Vec3::Zero());
  auto& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  magnetometer.heading_sigma_rad = 0.01;
  writer.write(estimate);
  magnetometer.status = MagnetometerStatus::Innovation;
  magnetometer.field_W = Vec3(1e-6, 24e-6, -38e-6);
  magnetometer.offset_B = Vec3(3e-7, 0.0, -1e-7);
  writer.write(estimate);
  const std::string states = read("states.csv");
  EXPECT_NE(states.find(",sigma_heading [rad],magnetometer,field_x [T],"), std::string::npos);
  EXPECT_NE(states.find(",0.01,off,nan,nan,nan,nan,nan,nan,"), std::string::npos);
  EXPECT_NE(states.find(",0.01,innovation,1e-06,2.4e-05,-3.8e-05,3e-07,0,-1e-07,"), std::string::npos);
}

TEST_F(RunFolder, SummaryTellsWhatBecameOfTheMagnetometer) {
  RunSummary summary;
  FrameEstimate estimate = estimateAt(0, Vec3::Zero());
  EXPECT_EQ(nlohmann::json::parse(summary.json({})).count("magnetometer"), 0u);
  auto& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  magnetometer.heading_reference = HeadingReference::True;
  magnetometer.heading_sigma_rad = 0.5 * M_PI / 180.0;
  for (const auto status : {MagnetometerStatus::Used, MagnetometerStatus::Norm, MagnetometerStatus::Norm}) {
    magnetometer.status = status;
    summary.add(estimate);
  }
  const auto json = nlohmann::json::parse(summary.json({}));
  EXPECT_EQ(json["heading"]["reference"], "true north");
  EXPECT_EQ(json["magnetometer"]["frames"]["norm"], 2);
  const std::string text = summary.text({}, true);
  EXPECT_NE(text.find("0.50 deg against true north"), std::string::npos);
  EXPECT_NE(text.find("used 33.3 %, norm 66.7 %; heading owes little to it"), std::string::npos);
}

TEST_F(RunFolder, StatesHaveThePressureSensor) {
  StateWriter writer(folder_);
  FrameEstimate estimate = estimateAt(5, Vec3::Zero());
  writer.write(estimate);
  auto& depth = estimate.sensors.of<DepthEstimate>();
  depth.status = DepthStatus::Jump;
  depth.gauge = DepthEstimate::Gauge{7.5, 0.975, 0.01, 0.5, 0.1, 9.25};
  writer.write(estimate);
  const std::string states = read("states.csv");
  EXPECT_NE(
      states.find(
          ",pressure,depth [m],depth_at_origin [m],density_ratio,pressure_lag [s],posterior_sigma_p_x [m],"),
      std::string::npos);
  EXPECT_NE(states.find(",off,nan,nan,nan,nan,"), std::string::npos);
  EXPECT_NE(states.find(",jump,9.25,7.5,0.975,0.5,"), std::string::npos);
}

TEST_F(RunFolder, SummaryTellsOfDepthAndWhatCarriedTheScale) {
  RunSummary summary;
  FrameEstimate estimate = estimateAt(0, Vec3::Zero());
  summary.add(estimate);
  EXPECT_EQ(nlohmann::json::parse(summary.json({})).count("pressure"), 0u);
  EXPECT_EQ(nlohmann::json::parse(summary.json({})).count("scale"), 0u);
  auto& depth = estimate.sensors.of<DepthEstimate>();
  depth.gauge = DepthEstimate::Gauge{7.5, 0.975, 0.01, 0.5, 0.1, 9.25};
  depth.status = DepthStatus::Used;
  estimate.scale = {6e4, 3e4, 1e4};
  summary.add(estimate);
  depth.status = DepthStatus::NoData;
  estimate.scale = {};
  summary.add(estimate);
  summary.add(estimate);
  const auto json = nlohmann::json::parse(summary.json({}));
  EXPECT_EQ(json["pressure"]["frames"]["used"], 1);
  EXPECT_EQ(json["pressure"]["frames"].count("no data"), 0u);
  EXPECT_EQ(json["pressure"]["gauge"]["lag_s"], 0.5);
  // Means over the four frames.
  EXPECT_NEAR(json["scale"]["sigma"], 1.0 / std::sqrt(2.5e4), 1e-12);
  EXPECT_NEAR(json["scale"]["stereo"]["share"], 0.6, 1e-12);
  EXPECT_NEAR(json["scale"]["stereo"]["sigma_without"], 0.01, 1e-12);
  EXPECT_NEAR(json["scale"]["depth"]["sigma_alone"], 0.02, 1e-12);
  EXPECT_NE(summary.text({}, true).find("60 % by stereo (alone 0.8 %), 30 % by accelerometer"),
            std::string::npos);
}

TEST_F(RunFolder, WaitingFramesAreNotWritten) {
  StateWriter writer(folder_);
  FrameEstimate waiting = estimateAt(1, Vec3::Zero());
  waiting.status = Status::Waiting;
  writer.write(waiting);
  EXPECT_EQ(read("trajectory.tum"), "# timestamp [s] x y z qx qy qz qw\n");
}

TEST_F(RunFolder, WaitingFramesWithAnAttitudeAreStatesButNoTrajectory) {
  StateWriter writer(folder_);
  FrameEstimate waiting = estimateAt(7, Vec3(1, 2, 3));
  waiting.status = Status::Waiting;
  AttitudeEstimate attitude;
  attitude.world_from_body = Quat(0.6, 0.0, 0.0, 0.8);
  attitude.heading_sigma_rad = 0.05;
  attitude.status = HeadingStatus::Magnetic;
  writer.write(waiting, attitude);
  EXPECT_EQ(read("trajectory.tum"), "# timestamp [s] x y z qx qy qz qw\n");
  std::istringstream states(read("states.csv"));
  std::string header;
  std::string row;
  std::getline(states, header);
  std::getline(states, row);
  EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(row.begin(), row.end(), ','));
  EXPECT_EQ(row.find("7,attitude,0,0,0,0,nan,nan,nan,0.6,0,0,0.8,nan,nan,nan,0,0,0,nan,nan,nan,"), 0U) << row;
  EXPECT_NE(row.find(",nan,nan,0.05,nan"), std::string::npos) << row;
  EXPECT_NE(row.find(",0.6,0,0,0.8,0.05,magnetic"), std::string::npos) << row;
}

TEST_F(RunFolder, UnwritableFolderIsNamed) {
  try {
    StateWriter writer(folder_ / "missing" / "folder");
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("trajectory.tum"), std::string::npos);
  }
}

TEST_F(RunFolder, LandmarksCanBeReadBack) {
  {
    LandmarkWriter writer(folder_);
    writer.write({{7, Vec3(1, 2, 3), 4}});
    writer.write({{8, Vec3(-1, 0.5, 9), 5}});
  }
  const std::string ply = read("landmarks.ply");
  EXPECT_NE(ply.find("element vertex 000000000002\n"), std::string::npos);
  const size_t data = ply.find("end_header\n") + 11;
  ASSERT_EQ(ply.size() - data, 2u * 16u);
  float second[3];
  int32_t observations;
  std::memcpy(second, ply.data() + data + 16, sizeof(second));
  std::memcpy(&observations, ply.data() + data + 28, sizeof(observations));
  EXPECT_EQ(second[1], 0.5f);
  EXPECT_EQ(observations, 5);
}

TEST_F(RunFolder, SummaryCountsPathCompletionAndFindings) {
  RunDescription description;
  description.data = "dive1";
  description.cameras = {"cam0", "cam1"};
  description.observation_sigma_px = 0.5;
  RunSummary summary(description);
  FrameEstimate waiting;
  waiting.time = Time::fromNanoseconds(0);
  summary.add(waiting);
  summary.add(estimateAt(1000000000, Vec3(0, 0, 0)));
  summary.add(estimateAt(2000000000, Vec3(3, 4, 0)));
  Diagnostics diagnostics;
  diagnostics.report(Severity::Serious, "imu_gap", "a gap");
  const auto json = nlohmann::json::parse(summary.json(diagnostics));
  EXPECT_DOUBLE_EQ(json["path_m"], 5.0);
  EXPECT_NEAR(json["completion"], 2.0 / 3.0, 1e-12);
  EXPECT_DOUBLE_EQ(json["duration_s"], 2.0);
  EXPECT_EQ(json["findings"][0]["kind"], "imu_gap");
  EXPECT_EQ(json["data"], "dive1");
  EXPECT_EQ(json["rig"]["cameras"].size(), 2u);
  EXPECT_FALSE(json["interrupted"]);
  EXPECT_NE(summary.text(diagnostics).find("a gap"), std::string::npos);
}

TEST_F(RunFolder, SummarySaysReprojectionInPixels) {
  RunDescription description;
  description.observation_sigma_px = 0.5;
  RunSummary summary(description);
  FrameEstimate estimate = estimateAt(0, Vec3::Zero());
  estimate.landmarks = 30;
  estimate.reprojection_rms_sigmas = 0.62;
  summary.add(estimate);
  EXPECT_NE(summary.text({}).find("0.31 px rms (0.62 sigma)"), std::string::npos);
}

TEST_F(RunFolder, FullDiskIsNoticedWhenFilesAreClosed) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  std::filesystem::create_symlink("/dev/full", folder_ / "landmarks.ply");
  LandmarkWriter writer(folder_);
  writer.write({{7, Vec3(1, 2, 3), 4}});
  EXPECT_THROW(writer.finish(HeadingReference::Start, std::nullopt), InputError);
  EXPECT_THROW(writeOutput("/dev/full", "text"), InputError);
}

}  // namespace
}  // namespace lodeline
