#include "lodeline/io/rosbag/convert/part_source.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

Rig oneCameraRig() {
  Rig rig;
  rig.cameras.resize(1);
  return rig;
}

/// Inertial readings at 10 Hz from 0.5 s on (the 15th and 16th exchanged) and images at 1 Hz from 1 s on. One
/// depth at 0 s starts the recording. Times count from an arbitrary stamp.
class TestSource final : public RecordedSource {
 public:
  TestSource() : RecordedSource(oneCameraRig()) {}

  static Time at(double seconds) {
    return Time::fromNanoseconds(1700000000000000000) + Duration::fromSeconds(seconds);
  }

  std::optional<ImuSample> nextRecordedImu() override {
    if (imu_ == kReadings) return std::nullopt;
    const int number = imu_ == 15 ? 16 : imu_ == 16 ? 15 : imu_;
    ++imu_;
    ImuSample sample;
    sample.time = at(0.5 + 0.1 * number);
    return sample;
  }
  std::optional<PendingImage> nextImage(size_t) override {
    if (image_ == 10) return std::nullopt;
    PendingImage image;
    image.time = at(1.0 + image_++);
    return image;
  }
  std::optional<DepthSample> nextDepth() override {
    if (has_given_depth_) return std::nullopt;
    has_given_depth_ = true;
    return DepthSample{at(0.0), 3.0};
  }
  int imuRead() const { return imu_; }

  static constexpr int kReadings = 1000;

 private:
  int imu_ = 0, image_ = 0;
  bool has_given_depth_ = false;
};

std::vector<double> imuTimes(PartSource* part) {
  std::vector<double> times;
  while (const auto sample = part->nextRecordedImu())
    times.push_back((sample->time - TestSource::at(0.0)).seconds());
  return times;
}

TEST(PartSource, HandsOnAllReadingsWhereNoPartIsAsked) {
  TestSource whole;
  PartSource part(&whole, {});
  EXPECT_EQ(imuTimes(&part).size(), static_cast<size_t>(TestSource::kReadings));
  EXPECT_TRUE(part.nextDepth().has_value());
  EXPECT_FALSE(part.nextDepth().has_value());
}

TEST(PartSource, CountsSecondsFromTheFirstReadingOfAnySensor) {
  TestSource whole;
  PartSource part(&whole, {1.95, 1.1});
  const std::vector<double> times = imuTimes(&part);
  ASSERT_EQ(times.size(), 11U);  // 2.0 to 3.0 s, in the stored order
  EXPECT_NEAR(times[0], 2.1, 1e-6);
  EXPECT_NEAR(times[1], 2.0, 1e-6);
  EXPECT_NEAR(times.back(), 3.0, 1e-6);
  std::vector<double> images;
  while (const auto image = part.nextImage(0))
    images.push_back((image->time - TestSource::at(0.0)).seconds());
  ASSERT_EQ(images.size(), 2U);
  EXPECT_NEAR(images[0], 2.0, 1e-6);
  EXPECT_NEAR(images[1], 3.0, 1e-6);
  EXPECT_FALSE(part.nextDepth().has_value());
  EXPECT_FALSE(part.nextSonar().has_value());
  EXPECT_TRUE(part.contains(TestSource::at(2.0)));
  EXPECT_FALSE(part.contains(TestSource::at(3.1)));
  // Nobody reads a long recording to its end for a short part.
  EXPECT_LT(whole.imuRead(), 150);
}

TEST(PartSource, IsEmptyBehindTheEnd) {
  TestSource whole;
  PartSource part(&whole, {1000.0, std::nullopt});
  EXPECT_TRUE(imuTimes(&part).empty());
  EXPECT_FALSE(part.nextImage(0).has_value());
}

}  // namespace
}  // namespace lodeline
