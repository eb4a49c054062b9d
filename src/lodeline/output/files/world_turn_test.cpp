#include "lodeline/output/files/world_turn.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>

#include "lodeline/geometry/so3.h"
#include "lodeline/output/files/landmark_file.h"
#include "lodeline/output/files/landmark_writer.h"
#include "lodeline/output/files/run_table.h"
#include "lodeline/output/files/state_writer.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

constexpr double kTurn_rad = 2.2;
constexpr double kTurnSigma_rad = 0.01;

// A run whose north is found with its third frame: estimates in the world of the first pose.
FrameEstimate estimateAt(int frame) {
  std::mt19937 random(static_cast<unsigned>(frame));
  std::normal_distribution<double> normal;
  FrameEstimate estimate;
  estimate.time = Time::fromSeconds(10.0 + frame);
  estimate.status = Status::Tracking;
  estimate.state.world_from_body =
      Rigid3(so3::exp(Vec3(0.1, -0.2, 0.3 * frame)), Vec3(2.0 + frame, -1.0, 0.5));
  estimate.state.velocity_W = Vec3(0.4, 0.1 * frame, -0.05);
  const Eigen::MatrixXd root =
      Eigen::MatrixXd::NullaryExpr(15, 15, [&](Eigen::Index, Eigen::Index) { return 0.1 * normal(random); });
  estimate.covariance = root * root.transpose();
  auto& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  magnetometer.heading_sigma_rad = std::sqrt(estimate.covariance(5, 5));
  if (frame < 2) return estimate;
  magnetometer.heading_reference = HeadingReference::Magnetic;
  magnetometer.field_W = so3::exp(-kTurn_rad * Vec3::UnitZ()) * Vec3(0.0, 24e-6, -38e-6);
  magnetometer.offset_B = Vec3::Zero();
  magnetometer.north_found = Time::fromSeconds(12.0);
  magnetometer.north_from_world_rad = kTurn_rad + (frame == 2 ? 0.02 : 0.0);
  magnetometer.north_from_world_sigma_rad = kTurnSigma_rad;
  return estimate;
}

class TurnedRun : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("lodeline_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    StateWriter writer(folder_);
    for (int frame = 0; frame < 4; ++frame) writer.write(estimateAt(frame));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
  WorldTurn turn_ = WorldTurn::of(estimateAt(3).sensors.of<MagnetometerEstimate>()).value();
};

TEST_F(TurnedRun, PointsToNorthFromTheFirstPoseOn) {
  turnStateFiles(folder_, "", turn_);
  Diagnostics diagnostics;
  const Trajectory turned = readTrajectory(folder_ / "trajectory.tum", {}, diagnostics);
  const RunTable states = readRunTable(folder_ / "states.csv", &diagnostics);
  ASSERT_EQ(turned.poses.size(), 4u);
  const Quat rotation = so3::exp(kTurn_rad * Vec3::UnitZ());
  for (size_t i = 0; i < 4; ++i) {
    const NavigationState before = estimateAt(static_cast<int>(i)).state;
    const Vec3 p = rotation * before.world_from_body.translation;
    const Quat q = rotation * before.world_from_body.rotation;
    EXPECT_LT((turned.poses[i].world_from_body.translation - p).norm(), 1e-8);
    EXPECT_LT(turned.poses[i].world_from_body.rotation.angularDistance(q), 1e-8);
    EXPECT_NEAR(states.numbers.at("p_y [m]")[i], p.y(), 1e-8);
    EXPECT_NEAR(states.numbers.at("v_x [m/s]")[i], (rotation * before.velocity_W).x(), 1e-8);
    EXPECT_NEAR(std::abs(Quat(states.numbers.at("q_w")[i], states.numbers.at("q_x")[i],
                              states.numbers.at("q_y")[i], states.numbers.at("q_z")[i])
                             .dot(q)),
                1.0, 1e-8);
  }
  EXPECT_NEAR(states.numbers.at("field_x [T]")[3], 0.0, 1e-13);
  EXPECT_NEAR(states.numbers.at("field_y [T]")[3], 24e-6, 1e-13);
}

// The last rows of a map are already in a world that points north.
TEST_F(TurnedRun, TurnsOnlyTheFirstPosesWhereTheOthersPointNorth) {
  const std::filesystem::path file = folder_ / "trajectory.tum";
  turnTrajectoryFile(file, turn_, 2);
  Diagnostics diagnostics;
  const Trajectory turned = readTrajectory(file, {}, diagnostics);
  ASSERT_EQ(turned.poses.size(), 4u);
  for (size_t i = 0; i < 4; ++i) {
    const Vec3 before = estimateAt(static_cast<int>(i)).state.world_from_body.translation;
    const Vec3 expected = i < 2 ? Vec3(so3::exp(kTurn_rad * Vec3::UnitZ()) * before) : before;
    EXPECT_LT((turned.poses[i].world_from_body.translation - expected).norm(), 1e-8) << i;
  }
}

TEST_F(TurnedRun, SaysWhereEachRowTookNorthToBe) {
  turnStateFiles(folder_, "", turn_);
  Diagnostics diagnostics;
  const std::vector<double> north =
      readRunTable(folder_ / "states.csv", &diagnostics).numbers.at("north_from_world [rad]");
  EXPECT_TRUE(std::isnan(north[0]) && std::isnan(north[1]));
  EXPECT_NEAR(north[2], 0.02, 1e-8);
  EXPECT_NEAR(north[3], 0.0, 1e-8);
}

TEST_F(TurnedRun, TurnsCovariancesAndAddsTheNorthThatRowsDidNotKnow) {
  turnStateFiles(folder_, "", turn_);
  Diagnostics diagnostics;
  const RunTable states = readRunTable(folder_ / "states.csv", &diagnostics);
  Eigen::Matrix<double, 9, 9> rotation = Eigen::Matrix<double, 9, 9>::Zero();
  for (int i = 0; i < 9; i += 3)
    rotation.block<3, 3>(i, i) = so3::exp(kTurn_rad * Vec3::UnitZ()).toRotationMatrix();
  for (int frame = 0; frame < 4; ++frame) {
    const FrameEstimate before = estimateAt(frame);
    Eigen::Matrix<double, 9, 1> by_turn;
    by_turn << Vec3::UnitZ().cross(before.state.world_from_body.translation), Vec3::UnitZ(),
        Vec3::UnitZ().cross(before.state.velocity_W);
    const double added = frame < 2 ? kTurnSigma_rad * kTurnSigma_rad : 0.0;
    const Eigen::Matrix<double, 9, 9> expected =
        rotation * (before.covariance.topLeftCorner<9, 9>() + added * by_turn * by_turn.transpose()) *
        rotation.transpose();
    const auto at = [&](const char* name) { return states.numbers.at(name)[static_cast<size_t>(frame)]; };
    EXPECT_NEAR(at("cov_pose_01"), expected(0, 1), 1e-8);
    EXPECT_NEAR(at("cov_pose_15"), expected(1, 5), 1e-8);
    EXPECT_NEAR(at("sigma_p_x [m]"), std::sqrt(expected(0, 0)), 1e-8);
    EXPECT_NEAR(at("sigma_theta_y [rad]"), std::sqrt(expected(4, 4)), 1e-8);
    EXPECT_NEAR(at("sigma_v_x [m/s]"), std::sqrt(expected(6, 6)), 1e-8);
    EXPECT_NEAR(at("sigma_v_y [m/s]"), std::sqrt(expected(7, 7)), 1e-8);
    EXPECT_NEAR(at("cov_v_01"), expected(6, 7), 1e-8);
    EXPECT_NEAR(at("sigma_heading [rad]"), std::sqrt(before.covariance(5, 5) + added), 1e-8);
  }
}

TEST_F(TurnedRun, LeavesARowOfTheAttitudeFilterAlone) {
  {
    StateWriter writer(folder_, "_waiting");
    FrameEstimate waiting;
    waiting.time = Time::fromSeconds(9.0);
    writer.write(waiting, AttitudeEstimate());
  }
  const auto read = [&] {
    std::ifstream stream(folder_ / "states_waiting.csv");
    std::stringstream text;
    text << stream.rdbuf();
    return text.str();
  };
  const std::string before = read();
  turnStateFiles(folder_, "_waiting", turn_);
  EXPECT_EQ(read(), before);
}

TEST_F(TurnedRun, TurnsLandmarksAndNamesTheirWorld) {
  const auto comment = [&] {
    std::ifstream stream(folder_ / "landmarks.ply");
    std::string line;
    for (int i = 0; i < 3; ++i) std::getline(stream, line);
    return line;
  };
  {
    LandmarkWriter writer(folder_);
    writer.write({{1, Vec3(3.0, -2.0, 1.0), 5}, {2, Vec3(0.0, 1.0, 0.0), 7}});
    writer.finish(HeadingReference::Magnetic, turn_);
  }
  Diagnostics diagnostics;
  const std::vector<MapLandmark> points = readLandmarkFile(folder_ / "landmarks.ply", &diagnostics);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_LT((points[0].position - turn_.apply(Vec3(3.0, -2.0, 1.0))).norm(), 1e-6);
  EXPECT_LT((points[1].position - turn_.apply(Vec3(0.0, 1.0, 0.0))).norm(), 1e-6);
  EXPECT_NE(comment().find("x east, y north (magnetic north)"), std::string::npos) << comment();
  {
    LandmarkWriter writer(folder_);
    writer.write({{1, Vec3(3.0, -2.0, 1.0), 5}});
    writer.finish(HeadingReference::Start, std::nullopt);
  }
  EXPECT_EQ(readLandmarkFile(folder_ / "landmarks.ply", &diagnostics).at(0).position, Vec3(3.0, -2.0, 1.0));
  EXPECT_NE(comment().find("x, y from the start heading"), std::string::npos) << comment();
  EXPECT_EQ(comment().find("east"), std::string::npos);
  { LandmarkWriter killed(folder_); }
  EXPECT_NE(comment().find("not completed"), std::string::npos) << comment();
}

}  // namespace
}  // namespace lodeline
