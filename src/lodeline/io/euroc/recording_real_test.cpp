#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>

#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/images/image_loader.h"
#include "lodeline/io/synchronizer/synchronizer.h"
#include "lodeline/util/files/test_data.h"

namespace lodeline {
namespace {

class Mh01 : public testing::Test {
 protected:
  void SetUp() override {
    const std::optional<std::filesystem::path> recording = testData(kMh01Recording);
    if (!recording) GTEST_SKIP() << missingTestData(kMh01Recording);
    data_ = *recording;
  }

  std::vector<FramePacket> readAll(const EurocOptions& euroc, const SynchronizerOptions& options) {
    EurocSource source(data_, euroc, &diagnostics_);
    Synchronizer synchronizer(&source, options, &diagnostics_);
    std::vector<FramePacket> packets;
    while (auto packet = synchronizer.next()) packets.push_back(std::move(*packet));
    return packets;
  }

  std::filesystem::path data_;
  Diagnostics diagnostics_;
};

TEST_F(Mh01, GivesOnePacketPerLeftImage) {
  const std::vector<FramePacket> packets = readAll({}, {});
  ASSERT_EQ(packets.size(), 288u);
  int right_images = 0;
  for (size_t i = 0; i < packets.size(); ++i) {
    const FramePacket& packet = packets[i];
    ASSERT_EQ(packet.images.size(), 2u);
    EXPECT_EQ(packet.images[0].size(), cv::Size(752, 480));
    EXPECT_EQ(packet.images[0].type(), CV_8UC1);
    right_images += packet.images[1].empty() ? 0 : 1;
    EXPECT_EQ(packet.imu.back().time, packet.time);
    if (i > 0) {
      EXPECT_EQ(packet.imu.front().time, packets[i - 1].time);
    }
    for (size_t j = 1; j < packet.imu.size(); ++j) EXPECT_LT(packet.imu[j - 1].time, packet.imu[j].time);
    EXPECT_LT(packet.longest_imu_gap_s, 0.006);
  }
  EXPECT_EQ(right_images, 287);
  EXPECT_EQ(diagnostics_.count("image_missing"), 1);
  EXPECT_EQ(diagnostics_.ranked().size(), 1u);
  // The recording has 5 s of inertial data before the first image.
  EXPECT_NEAR((packets[0].time - packets[0].imu.front().time).seconds(), 5.0, 0.01);
}

TEST_F(Mh01, PrefetchingChangesNothing) {
  SynchronizerOptions prefetching;
  prefetching.prefetch = true;
  prefetching.duration_s = 2.0;
  SynchronizerOptions plain = prefetching;
  plain.prefetch = false;
  const std::vector<FramePacket> a = readAll({}, plain);
  const std::vector<FramePacket> b = readAll({}, prefetching);
  ASSERT_EQ(a.size(), 41u);
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].time, b[i].time);
    EXPECT_EQ(a[i].imu.size(), b[i].imu.size());
    for (int c = 0; c < 2; ++c) {
      ASSERT_EQ(a[i].images[c].size(), b[i].images[c].size());
      EXPECT_TRUE(std::equal(a[i].images[c].datastart, a[i].images[c].dataend, b[i].images[c].datastart));
    }
  }
}

TEST_F(Mh01, DecodesTheSamePixelsAsOpenCv) {
  int compared = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data_ / "mav0" / "cam1" / "data")) {
    if (compared++ == 20) break;
    const cv::Mat expected = cv::imread(entry.path().string(), cv::IMREAD_GRAYSCALE);
    const cv::Mat image = loadGreyImage(entry.path()).image;
    ASSERT_EQ(image.size(), expected.size());
    EXPECT_TRUE(std::equal(image.datastart, image.dataend, expected.datastart)) << entry.path();
  }
}

TEST_F(Mh01, StartsLaterWithHistory) {
  SynchronizerOptions options;
  options.skip_s = 5.0;
  EurocOptions right_only;
  right_only.camera_indices = {1};
  const std::vector<FramePacket> packets = readAll(right_only, options);
  ASSERT_GT(packets.size(), 180u);
  EXPECT_EQ(packets[0].images.size(), 1u);
  EXPECT_NEAR((packets[0].time - packets[0].imu.front().time).seconds(), 10.0, 0.02);
}

}  // namespace
}  // namespace lodeline
