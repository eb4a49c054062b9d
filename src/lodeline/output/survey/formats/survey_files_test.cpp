#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/survey.h"

namespace lodeline {
namespace {

/// A walk of 0.2 m a step along x of its world, whose positions are known to 1 cm along x and 2 cm across.
std::vector<FrameEstimate> walk(int steps) {
  std::vector<FrameEstimate> estimates(1);  // the first one waits
  for (int i = 0; i < steps; ++i) {
    FrameEstimate estimate;
    estimate.time = Time::fromSeconds(1.8e9 + i);
    estimate.status = Status::Tracking;
    estimate.state.world_from_body = Rigid3(Quat::Identity(), Vec3(0.2 * i, 0.0, -0.02 * i));
    estimate.covariance.diagonal().head<3>() = Vec3(1e-4, 4e-4, 1e-4);
    estimates.push_back(estimate);
  }
  return estimates;
}

TEST(RunOf, TakesPosesUncertaintiesAndLandmarks) {
  std::vector<FrameEstimate> estimates = walk(10);
  estimates.back().sensors.of<DepthEstimate>().gauge =
      DepthEstimate::Gauge{.depth_at_origin_m = 9.0, .density_ratio = 2.0};
  const RunFolder run = runOf("dive", estimates, {{7, Vec3(1.0, 2.0, 3.0), 5}});
  ASSERT_EQ(run.trajectory.size(), 10u) << "without the estimate that has no pose";
  EXPECT_EQ(run.trajectory.poses[9].world_from_body.translation,
            estimates.back().state.world_from_body.translation);
  EXPECT_EQ(run.uncertainties.size(), 10u);
  EXPECT_EQ(run.uncertainties[3].covariance, Vec3(1e-4, 4e-4, 1e-4).asDiagonal().toDenseMatrix());
  ASSERT_EQ(run.landmarks.size(), 1u);
  EXPECT_EQ(run.landmarks[0].position, Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(run.heading_reference, HeadingReference::Start);
  EXPECT_FALSE(run.heading_sigma_rad.has_value());
  EXPECT_EQ(run.depth_at_origin_m, 4.5);
}

// A quarter turn takes x to y. Before north was found, its sigma makes positions uncertain across their
// distance.
TEST(RunOf, TurnsToANorthThatWasFoundLater) {
  std::vector<FrameEstimate> estimates = walk(11);
  MagnetometerEstimate& north = estimates.back().sensors.of<MagnetometerEstimate>();
  north.heading_reference = HeadingReference::True;
  north.heading_sigma_rad = 0.02;
  north.north_from_world_rad = M_PI / 2.0;
  north.north_from_world_sigma_rad = 0.1;
  north.north_found = estimates[6].time;
  const RunFolder run = runOf("dive", estimates, {{7, Vec3(1.0, 0.0, 0.0), 5}});
  EXPECT_LT((run.trajectory.poses[10].world_from_body.translation - Vec3(0.0, 2.0, -0.2)).norm(), 1e-12);
  EXPECT_LT((run.landmarks[0].position - Vec3(0.0, 1.0, 0.0)).norm(), 1e-12);
  const double across_m2 = std::pow(0.1 * 0.8, 2);  // the fifth pose, 0.8 m from the first
  EXPECT_NEAR(run.uncertainties[4].covariance(0, 0), 4e-4 + across_m2, 1e-12);
  EXPECT_NEAR(run.uncertainties[4].covariance(1, 1), 1e-4, 1e-12);
  EXPECT_NEAR(run.uncertainties[9].covariance(0, 0), 4e-4, 1e-12) << "contains north already";
  EXPECT_EQ(run.heading_reference, HeadingReference::True);
  EXPECT_EQ(run.heading_sigma_rad, 0.02);
}

TEST(RunOf, RefusesARunWithoutPose) {
  EXPECT_THROW(runOf("dive", std::vector<FrameEstimate>(3), {}), InputError);
  EXPECT_THROW(runOf("dive", {}, {}), InputError);
}

TEST(WriteSurvey, WritesTheFormatsAndTheNotes) {
  test::TemporaryFolder folder;
  Diagnostics diagnostics;
  DiveMapOptions options;
  options.name = "dive";
  const std::vector<std::filesystem::path> files =
      writeSurvey(runOf("dive", walk(100), {}), options, {MapFormat::Survex, MapFormat::Csv},
                  folder.path() / "map", &diagnostics);
  ASSERT_GE(files.size(), 4u);
  for (const std::filesystem::path& file : files) EXPECT_TRUE(std::filesystem::exists(file)) << file;
  EXPECT_EQ(files.front().filename(), "dive.svx");
  EXPECT_EQ(files.back().filename(), "dive_notes.txt");
}

TEST(WriteSurvey, RefusesAPositionThatIsNotKnown) {
  test::TemporaryFolder folder;
  Diagnostics diagnostics;
  EXPECT_THROW(
      writeSurvey(runOf("dive", walk(100), {}), {}, {MapFormat::Kml}, folder.path() / "map", &diagnostics),
      UsageError);
}

}  // namespace
}  // namespace lodeline
