#include <gtest/gtest.h>

#include <numbers>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/output/survey/formats/recording_images.h"
#include "lodeline/output/survey/formats/recording_walls.h"
#include "lodeline/util/files/output_file.h"

// Tests of the recording's additions to a map: echoes of the sonar, images.

namespace lodeline {
namespace {

/// A recording given by lists of measurements.
class ListedSource : public MeasurementSource {
 public:
  const Rig& rig() const override { return rig_; }
  std::optional<ImuSample> nextImu() override { return std::nullopt; }
  std::optional<PendingImage> nextImage(size_t camera) override {
    return next_image_ < images_.size() && camera == 0 ? std::optional(images_[next_image_++]) : std::nullopt;
  }
  std::optional<SonarSample> nextSonar() override {
    return next_echo_ < echoes_.size() ? std::optional(echoes_[next_echo_++]) : std::nullopt;
  }

  Rig rig_;
  std::vector<PendingImage> images_;
  std::vector<SonarSample> echoes_;

 private:
  size_t next_image_ = 0, next_echo_ = 0;
};

/// Motion at 1 m/s along x from second 10 on, 10 Hz, without rotation.
Trajectory straightWay() {
  Trajectory trajectory;
  for (int i = 0; i <= 20; ++i) {
    trajectory.poses.push_back(
        {Time::fromSeconds(10.0 + 0.1 * i), Rigid3(Quat::Identity(), Vec3(0.1 * i, 0, 0))});
  }
  return trajectory;
}

TEST(SonarWalls, LieWhereTheBeamEnded) {
  ListedSource source;
  SonarCalibration sonar;
  // Its x axis points to the body's left, its y axis up.
  Mat3 rotation;
  rotation << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  sonar.body_from_sonar = Rigid3(Quat(rotation), Vec3(0.0, 0.0, 0.5));
  source.rig_.sonar = sonar;
  source.echoes_ = {{Time::fromSeconds(10.55), 2.0, 0.0},
                    {Time::fromSeconds(11.0), 3.0, 0.5 * std::numbers::pi},
                    {Time::fromSeconds(11.1), -1.0, 0.0},
                    {Time::fromSeconds(9.0), 2.0, 0.0},
                    {Time::fromSeconds(13.0), 2.0, 0.0}};
  Diagnostics diagnostics;
  std::vector<double> shares;
  const std::vector<Vec3> walls =
      sonarWalls(source, straightWay(), &diagnostics, [&](double share) { shares.push_back(share); });
  ASSERT_EQ(walls.size(), 2U);
  ASSERT_EQ(shares.size(), 5U);
  EXPECT_GT(shares[0], 0.0);
  EXPECT_GT(shares[1], shares[0]);
  EXPECT_EQ(shares[3], 0.0);  // before the first pose
  EXPECT_EQ(shares[4], 1.0);  // behind the last one
  EXPECT_LT((walls[0] - Vec3(0.55, 2.0, 0.5)).norm(), 1e-9);
  EXPECT_LT((walls[1] - Vec3(1.0, 0.0, 3.5)).norm(), 1e-9);
  EXPECT_EQ(diagnostics.count("sonar_without_pose"), 1);
}

TEST(RecordingImages, BelongToThePosesOfTheirTimes) {
  ListedSource source;
  CameraCalibration camera;
  camera.time_offset_to_imu_s = 0.02;
  camera.body_from_camera = Rigid3(Quat::Identity(), Vec3(0.1, 0.0, 0.0));
  camera.name = "cam0";
  source.rig_.cameras = {camera};
  const test::TemporaryFolder recording;
  const std::filesystem::path file = recording.path() / "cam0" / "data" / "7.png";
  std::filesystem::create_directories(file.parent_path());
  writeOutput(file, "");
  source.images_ = {{Time::fromSeconds(9.98), file.string(), {}},
                    {Time::fromSeconds(10.083), "dive.bag: /camera/image at 10.083", {}},
                    {Time::fromSeconds(10.23), file.string(), {}},
                    {Time::fromSeconds(50.0), file.string(), {}}};
  RunFolder run;
  run.trajectory = straightWay();
  Eigen::Matrix<double, 6, 1> correction;
  correction << 0.0, 0.0, 0.01, 0.002, 0.0, 0.0;
  run.camera_corrections = {correction};
  camera.fx_px = 400.0;
  source.rig_.cameras = {camera};
  IntrinsicsCorrection lens = IntrinsicsCorrection::Zero();
  lens[0] = 0.01;
  run.intrinsics_corrections = {lens};
  Diagnostics diagnostics;
  const MapImages images = recordingImages(source, run, &diagnostics);
  ASSERT_EQ(images.images.size(), 2U);
  EXPECT_EQ(images.images[0].pose, 0U);
  EXPECT_EQ(images.images[1].pose, 1U);
  EXPECT_EQ(images.images[0].name, "cam0/data/7.png");
  EXPECT_EQ(images.images[1].name, "cam0/data/10083000000.png");
  EXPECT_NEAR(images.cameras[0].body_from_camera.translation.x(), 0.102, 1e-12);
  EXPECT_NEAR(images.cameras[0].fx_px, 404.0, 1e-9);
  EXPECT_NEAR(images.cameras[0].body_from_camera.rotation.angularDistance(Quat::Identity()), 0.01, 1e-9);
}

TEST(RecordingImages, OfAnotherRecordingAreReported) {
  ListedSource source;
  source.rig_.cameras = {CameraCalibration()};
  RunFolder run;
  run.trajectory = straightWay();
  Diagnostics diagnostics;
  EXPECT_TRUE(recordingImages(source, run, &diagnostics).images.empty());
  EXPECT_EQ(diagnostics.count("no_image_with_pose"), 1);
}

}  // namespace
}  // namespace lodeline
