#include "lodeline/survey.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr const char* kPoses = "# t x y z qx qy qz qw\n100.5 0 0 0 0 0 0 1\n101.5 1 2 3 0 0 0 1\n";
constexpr const char* kStates =
    "#timestamp [ns],cov_pose_00,cov_pose_01,cov_pose_02,other,cov_pose_11,cov_pose_12,cov_pose_22\n"
    "100500000000,1,0,0,x,1,0,1\n"
    "101000000000,nan,0,0,x,1,0,1\n"
    "101500000000,4,1,0,x,9,2,16\n"
    "1020000";
constexpr const char* kSummary =
    R"({"program": "lodeline 9", "data": "dive1", "heading": {"reference": "magnetic north", "sigma_rad": 0.01}})";

std::string plyOf(const std::vector<MapLandmark>& landmarks) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment x\nelement vertex " + std::to_string(landmarks.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nproperty int observations\nend_header\n";
  for (const MapLandmark& landmark : landmarks) {
    const Eigen::Vector3f position = landmark.position.cast<float>();
    const int32_t observations = landmark.observations;
    bytes.append(reinterpret_cast<const char*>(position.data()), 12);
    bytes.append(reinterpret_cast<const char*>(&observations), 4);
  }
  return bytes;
}

class RunFolderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("trajectory.tum", kPoses);
    folder_.write("states.csv", kStates);
    folder_.write("run.json", kSummary);
    folder_.write("landmarks.ply", plyOf({{{1, 2, 3}, 7}, {{4, 5, NAN}, 1}}));
    folder_.write("config.yaml", "heading:\n  site: [29.83, -82.6, 5]\n  date: \"2026-11-21\"\n");
  }
  RunFolder read() { return readRunFolder(folder_.path(), &diagnostics_); }
  void expectRefusal(const char* says) {
    EXPECT_THAT([&] { read(); }, ThrowsMessage<InputError>(HasSubstr(says)));
  }

  test::TemporaryFolder folder_;
  Diagnostics diagnostics_;
};

TEST_F(RunFolderTest, GivesWhatTheRunKnew) {
  const RunFolder run = read();
  EXPECT_EQ(run.trajectory.size(), 2U);
  EXPECT_EQ(run.trajectory_file, "trajectory.tum");
  ASSERT_EQ(run.uncertainties.size(), 2U);
  EXPECT_EQ(run.uncertainties[1].covariance(0, 1), 1.0);
  EXPECT_EQ(run.uncertainties[1].covariance(2, 1), 2.0);
  EXPECT_EQ(run.uncertainties[1].covariance(2, 2), 16.0);
  ASSERT_EQ(run.landmarks.size(), 1U);
  EXPECT_EQ(run.landmarks[0].observations, 7);
  EXPECT_EQ(run.heading_reference, HeadingReference::Magnetic);
  EXPECT_EQ(run.program, "lodeline 9");
  ASSERT_TRUE(run.site);
  EXPECT_EQ(run.site->longitude_deg, -82.6);
  EXPECT_EQ(run.date, "2026-11-21");
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(RunFolderTest, PrefersTheRefinedTrajectory) {
  folder_.write("trajectory_refined.tum", "100.5 0 0 0 0 0 0 1\n101.5 9 2 3 0 0 0 1\n");
  folder_.write("landmarks_refined.ply", plyOf({{{1, 2, 3}, 8}, {{1, 2, 3}, 9}}));
  const RunFolder run = read();
  EXPECT_EQ(run.trajectory.poses[1].world_from_body.translation.x(), 9.0);
  ASSERT_EQ(run.landmarks.size(), 2U);
  EXPECT_EQ(run.landmarks[1].observations, 9);
  EXPECT_EQ(run.uncertainties.size(), 2U) << "of states.csv, where there is no refined one";
}

TEST_F(RunFolderTest, MakesDoWithPosesAlone) {
  for (const char* name : {"states.csv", "run.json", "landmarks.ply", "config.yaml"}) {
    std::filesystem::remove(folder_.path() / name);
  }
  const RunFolder run = read();
  EXPECT_EQ(run.heading_reference, HeadingReference::Start);
  EXPECT_EQ(diagnostics_.ranked().size(), 3U);
}

TEST_F(RunFolderTest, NamesWhatItCannotUnderstand) {
  const std::string ply = plyOf({{{1, 2, 3}, 7}, {{1, 2, 3}, 7}});
  // A killed run keeps its results.
  folder_.write("landmarks.ply", ply.substr(0, 60));
  EXPECT_EQ(read().landmarks.size(), 0U);
  folder_.write("landmarks.ply", ply.substr(0, ply.size() - 5));
  EXPECT_EQ(read().landmarks.size(), 1U);
  EXPECT_EQ(diagnostics_.count("landmarks_incomplete"), 2);
  folder_.write("landmarks.ply", "solid stl\n");
  expectRefusal("no PLY file");
  SetUp();
  folder_.write("run.json", "{\"heading\": {\"reference\": \"west\"}}");
  expectRefusal("'west'");
  folder_.write("run.json", "{");
  expectRefusal("run.json");
  SetUp();
  folder_.write("states.csv", "a,b\n1,2\n");
  expectRefusal("no column 'cov_pose_00'");
  std::filesystem::remove(folder_.path() / "trajectory.tum");
  expectRefusal("no trajectory.tum there");
}

}  // namespace
}  // namespace lodeline
