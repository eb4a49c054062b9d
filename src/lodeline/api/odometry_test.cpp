#include "lodeline/odometry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/util/files/test_data.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

std::filesystem::path sampleDive() { return testSourceDir() / "samples/cave_dive"; }

std::vector<FrameEstimate> all(Odometry* odometry) {
  std::vector<FrameEstimate> estimates;
  while (const auto estimate = odometry->next()) estimates.push_back(*estimate);
  return estimates;
}

/// All readings of the sample dive up to `seconds` after its first image, as its drivers would push them.
void push(double seconds, LiveSource* rig) {
  Diagnostics diagnostics;
  const auto recording = openEuroc(sampleDive(), {}, &diagnostics);
  std::optional<Time> end;
  for (size_t camera = 0; camera < recording->rig().cameras.size(); ++camera) {
    while (const auto image = recording->nextImage(camera)) {
      if (!end) end = image->time + Duration::fromSeconds(seconds);
      if (image->time > *end) break;
      rig->push(camera, imageInMemory(image->time, image->load().image));
    }
  }
  while (const auto sample = recording->nextImu()) rig->push(*sample);
  while (const auto sample = recording->nextMagnetometer()) rig->push(*sample);
  while (const auto sample = recording->nextDepth()) rig->push(*sample);
  rig->close();
}

TEST(Odometry, EstimatesTheSameFromARecordingAndFromItsReadings) {
  Diagnostics diagnostics;
  OdometrySettings settings;
  settings.set("source.duration_s", "1.5");
  const auto source = openEuroc(sampleDive(), settings.recording(), &diagnostics);
  Odometry recorded(source.get(), settings, &diagnostics);
  const std::vector<FrameEstimate> expected = all(&recorded);

  LiveSourceOptions options;
  options.max_images = 1000;
  options.max_readings = 1'000'000;
  LiveSource rig(source->rig(), options, &diagnostics);
  push(3.0, &rig);
  Odometry fed(&rig, settings, &diagnostics);
  const std::vector<FrameEstimate> estimates = all(&fed);

  ASSERT_EQ(estimates.size(), expected.size());
  ASSERT_GT(estimates.size(), 10u);
  EXPECT_EQ(estimates.back().status, Status::Tracking);
  for (size_t i = 0; i < estimates.size(); ++i) {
    EXPECT_EQ(estimates[i].time, expected[i].time);
    EXPECT_EQ(estimates[i].state.world_from_body.matrix(), expected[i].state.world_from_body.matrix()) << i;
    EXPECT_EQ(estimates[i].covariance, expected[i].covariance) << i;
  }
}

TEST(Odometry, RefinesWhatItKept) {
  Diagnostics diagnostics;
  OdometrySettings settings;
  settings.set("source.duration_s", "2");
  const auto source = openEuroc(sampleDive(), settings.recording(), &diagnostics);
  Odometry odometry(source.get(), settings, &diagnostics);
  odometry.keepForRefinement(0.0);
  EXPECT_THROW(odometry.refine(), UsageError) << "the source has not ended";
  size_t poses = 0;
  for (const FrameEstimate& estimate : all(&odometry)) poses += estimate.status == Status::Waiting ? 0 : 1;
  EXPECT_FALSE(odometry.takeLandmarks().empty());
  EXPECT_TRUE(odometry.takeLandmarks().empty()) << "each landmark is given once";
  EXPECT_FALSE(odometry.next().has_value());
  const Refinement refinement = odometry.refine();
  EXPECT_EQ(refinement.frames.size(), poses);
  EXPECT_LE(refinement.summary.first_round_cost, refinement.summary.forward_cost);
}

TEST(Odometry, RefusesToRefineWhatItDidNotKeep) {
  Diagnostics diagnostics;
  OdometrySettings settings;
  settings.set("source.duration_s", "0.2");
  const auto source = openEuroc(sampleDive(), settings.recording(), &diagnostics);
  Odometry odometry(source.get(), settings, &diagnostics);
  all(&odometry);
  EXPECT_THROW(odometry.refine(), UsageError);
}

TEST(Odometry, RefusesARigWithoutCamera) {
  Diagnostics diagnostics;
  LiveSource rig(Rig(), {}, &diagnostics);
  EXPECT_THROW(Odometry(&rig, {}, &diagnostics), InputError);
}

TEST(OdometrySettings, AreWrittenAndRead) {
  test::TemporaryFolder folder;
  OdometrySettings settings;
  settings.set("front_end.max_tracks", "77");
  settings.set("source.cameras", "[1]");
  std::ostringstream text;
  settings.write(text);
  folder.write("config.yaml", text.str());
  OdometrySettings read;
  read.load(folder.path() / "config.yaml");
  std::ostringstream again;
  read.write(again);
  EXPECT_EQ(again.str(), text.str());
  EXPECT_THAT(text.str(), HasSubstr("77"));
  EXPECT_EQ(read.recording().camera_indices, std::vector<int>{1});
}

TEST(OdometrySettings, RefuseUnknownKeys) {
  OdometrySettings settings;
  EXPECT_THROW(settings.set("front_end.max_track", "1"), UsageError);
  EXPECT_THROW(settings.set("front_end.max_tracks", "many"), UsageError);
}

// The first seconds of a recording whose gyroscope counts degrees per second.
TEST(OdometrySettings, AdaptToTheUnitsOfARecording) {
  class InDegrees : public RecordedSource {
   public:
    explicit InDegrees(std::unique_ptr<RecordedSource> source)
        : RecordedSource(source->rig()), source_(std::move(source)) {}
    std::optional<ImuSample> nextRecordedImu() override {
      std::optional<ImuSample> sample = source_->nextImu();
      if (sample) sample->angular_velocity_B *= 180.0 / M_PI;
      return sample;
    }
    std::optional<PendingImage> nextImage(size_t camera) override { return source_->nextImage(camera); }

   private:
    std::unique_ptr<RecordedSource> source_;
  };
  Diagnostics diagnostics;
  const RecordingOpener open = [](Diagnostics* findings) -> std::unique_ptr<RecordedSource> {
    return std::make_unique<InDegrees>(openEuroc(sampleDive(), {}, findings));
  };
  OdometrySettings settings;
  settings.set("source.duration_s", "8");
  settings.adaptTo(open, "dive", &diagnostics);
  EXPECT_EQ(diagnostics.count("gyroscope_unit"), 1);
}

}  // namespace
}  // namespace lodeline
