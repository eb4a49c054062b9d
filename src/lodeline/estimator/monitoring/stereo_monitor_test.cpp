#include "lodeline/estimator/monitoring/stereo_monitor.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace lodeline {
namespace {

constexpr int kWidth_px = 640, kHeight_px = 480;

/// Two cameras side by side, of the same direction.
Rig sideBySide() {
  Rig rig;
  for (int i = 0; i < 2; ++i) {
    CameraCalibration camera;
    camera.name = "cam" + std::to_string(i);
    camera.width_px = kWidth_px;
    camera.height_px = kHeight_px;
    camera.fx_px = camera.fy_px = 400.0;
    camera.cx_px = 320.0;
    camera.cy_px = 240.0;
    camera.body_from_camera.translation = Vec3(0.1 * i, 0.0, 0.0);
    rig.cameras.push_back(camera);
  }
  return rig;
}

/// A wall of random spots, moved by a disparity.
cv::Mat wall(double right_px, double down_px) {
  cv::RNG random(7);
  cv::Mat noise(kHeight_px, kWidth_px, CV_8U), spots, moved;
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, spots, {}, 2.5);
  cv::normalize(spots, spots, 0, 255, cv::NORM_MINMAX);
  const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1.0, 0.0, right_px, 0.0, 1.0, down_px);
  cv::warpAffine(spots, moved, shift, spots.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  return moved;
}

const double kDisparity_px = 30.0;
const cv::Mat kLeft = wall(0.0, 0.0), kRight = wall(-kDisparity_px, 0.0),
              kFromAnotherMoment = wall(10.0, 25.0);

class StereoMonitorTest : public testing::Test {
 protected:
  /// Shows a pair of images whose tracks do not match, as the front end finds them where a pair is wrong.
  /// Returns whether the monitor exchanges the images or takes an exchange back.
  bool show(const cv::Mat& first, const cv::Mat& second) {
    FramePacket packet;
    packet.time = packet.image_stamp = Time::fromSeconds(100.0 + frames_++);
    packet.images = {first, second};
    const std::vector<cv::Mat> images = monitor_.arrange(packet);
    is_first_first_ = images[0].data == first.data;
    FrameTracks tracks;
    for (int i = 0; i < 100; ++i) {
      FeatureObservation observation;
      observation.track = i;
      tracks.observations.push_back(observation);
    }
    return monitor_.judge(packet, images, tracks);
  }

  Diagnostics diagnostics_;
  StereoMonitor monitor_{sideBySide(), &diagnostics_};
  int frames_ = 0;
  bool is_first_first_ = true;
};

TEST_F(StereoMonitorTest, ExchangesImagesThatWereExchanged) {
  EXPECT_TRUE(show(kRight, kLeft));
  for (int i = 0; i < 5; ++i) {
    EXPECT_FALSE(show(kRight, kLeft));
    EXPECT_FALSE(is_first_first_);
  }
  EXPECT_EQ(diagnostics_.count("cameras_swapped"), 1);
}

// A second image of another moment looks exchanged while the rig turns to one side, and later no more.
TEST_F(StereoMonitorTest, TakesBackAnExchangeThatTheNextImagesContradict) {
  EXPECT_TRUE(show(kRight, kLeft));
  EXPECT_TRUE(show(kRight, kFromAnotherMoment));
  EXPECT_FALSE(show(kRight, kLeft)) << "one comparison is not enough a second time";
  EXPECT_TRUE(is_first_first_);
  EXPECT_FALSE(show(kRight, kFromAnotherMoment));
  EXPECT_TRUE(is_first_first_);
}

TEST_F(StereoMonitorTest, LeavesOutACameraThatFitsNoArrangement) {
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(show(kLeft, kFromAnotherMoment));
  EXPECT_EQ(diagnostics_.count("stereo_contradicts"), 1);
  EXPECT_EQ(diagnostics_.count("cameras_swapped"), 0);
}

}  // namespace
}  // namespace lodeline
