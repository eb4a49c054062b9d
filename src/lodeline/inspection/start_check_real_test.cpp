#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/inspection/start_check.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/util/files/test_data.h"

// Tests on a real recording with delayed stamps of one or all cameras.

namespace lodeline {
namespace {

using ::testing::ContainsRegex;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A recording with shifted time stamps of each camera's images.
class LateImages : public MeasurementSource {
 public:
  LateImages(std::unique_ptr<MeasurementSource> source, std::vector<double> late_s)
      : source_(std::move(source)), late_s_(std::move(late_s)) {}

  const Rig& rig() const override { return source_->rig(); }
  std::optional<ImuSample> nextImu() override { return source_->nextImu(); }
  std::optional<PendingImage> nextImage(size_t camera) override {
    std::optional<PendingImage> image = source_->nextImage(camera);
    if (image) image->time = image->time + Duration::fromSeconds(late_s_[camera]);
    return image;
  }

 private:
  std::unique_ptr<MeasurementSource> source_;
  std::vector<double> late_s_;
};

class StartCheckRealTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto recording = testData(kMh01Recording);
    if (!recording) GTEST_SKIP() << missingTestData(kMh01Recording);
    recording_ = *recording;
  }

  StartCheck check(const std::vector<double>& late_s) {
    const auto open = [&](Diagnostics* diagnostics) {
      return std::make_unique<LateImages>(
          std::make_unique<EurocSource>(recording_, EurocOptions(), diagnostics), late_s);
    };
    return checkStart(open, "dive7", StartCheckOptions(), &diagnostics_);
  }

  std::filesystem::path recording_;
  Diagnostics diagnostics_;
};

TEST_F(StartCheckRealTest, CorrectsNothingInASoundRecording) {
  EXPECT_THAT(check({0.0, 0.0}).image_offset_s, ElementsAre(0.0, 0.0));
  EXPECT_EQ(diagnostics_.count(kCameraTimeOffset), 0);
}

TEST_F(StartCheckRealTest, CorrectsCamerasThatAreLateTogether) {
  EXPECT_THAT(check({0.05, 0.05}).image_offset_s,
              ElementsAre(DoubleNear(-0.05, 3e-3), DoubleNear(-0.05, 3e-3)));
  ASSERT_GE(diagnostics_.count(kCameraTimeOffset), 1);
  EXPECT_THAT(diagnostics_.ranked().front().first_message,
              HasSubstr("keep the stamps as they were recorded"));
}

TEST_F(StartCheckRealTest, CorrectsTheSecondCameraWhereItIsLateAlone) {
  EXPECT_THAT(check({0.0, 0.1}).image_offset_s, ElementsAre(0.0, DoubleNear(-0.1, 3e-3)));
}

TEST_F(StartCheckRealTest, NamesASecondCameraThatIsLateBySeconds) {
  check({0.0, 2.5});
  ASSERT_EQ(diagnostics_.count(kCameraTimeOffset), 1);
  EXPECT_THAT(diagnostics_.ranked().front().first_message,
              ContainsRegex("cam1: .* lag behind the gyroscope's by (249[789]|250[0123]) ms"));
}

TEST_F(StartCheckRealTest, NamesALagOfOneFrame) {
  check({0.0, 0.05});
  ASSERT_EQ(diagnostics_.count(kCameraTimeOffset), 1);
  EXPECT_THAT(diagnostics_.ranked().front().first_message, HasSubstr("which is 1 frame: each image carries"));
}

TEST_F(StartCheckRealTest, LeavesTheSecondCameraWhereTheFirstIsLateAlone) {
  EXPECT_THAT(check({0.1, 0.0}).image_offset_s, ElementsAre(DoubleNear(-0.1, 3e-3), 0.0));
}

}  // namespace
}  // namespace lodeline
