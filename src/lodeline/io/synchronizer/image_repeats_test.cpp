#include "lodeline/io/synchronizer/image_repeats.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

namespace lodeline {
namespace {

using testing::HasSubstr;

constexpr double kRate_hz = 20.0;

Rig rigOf(size_t cameras) {
  Rig rig;
  for (size_t i = 0; i < cameras; ++i) {
    CameraCalibration camera;
    camera.name = "cam" + std::to_string(i);
    camera.width_px = 96;
    camera.height_px = 64;
    camera.fx_px = camera.fy_px = 100.0;
    rig.cameras.push_back(camera);
  }
  return rig;
}

/// An image that moves by two pixels per image, each with `noise_grey` of its own noise.
cv::Mat picture(int number, int noise_grey = 0, int seed = 0) {
  cv::Mat image(64, 96, CV_8UC1);
  cv::RNG random(static_cast<uint64_t>(1000 * seed + number) + 1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double level = 128 + 50 * std::sin(0.3 * (x + 2 * number)) * std::cos(0.2 * y) +
                           40 * std::sin(0.07 * (x + 2 * number));
      image.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(
          level + (noise_grey > 0 ? random.uniform(-noise_grey, noise_grey + 1) : 0));
    }
  }
  return image;
}

class ImageRepeatsTest : public testing::Test {
 protected:
  /// Screens consecutive images together with the readings of a rig that rotates by `rate_rad_per_s` and
  /// vibrates, or rests. Returns which packets keep their first image; `references_` gets the state of each.
  std::vector<bool> kept(const std::vector<cv::Mat>& first, const std::vector<cv::Mat>& second,
                         const std::function<double(double)>& rate_rad_per_s, bool shakes = true) {
    ImageRepeats repeats(rigOf(second.empty() ? 1 : 2), &diagnostics_);
    std::vector<bool> result;
    for (size_t i = 0; i < first.size(); ++i) {
      FramePacket packet;
      packet.time = packet.image_stamp = Time::fromSeconds(100.0 + static_cast<double>(i) / kRate_hz);
      for (int j = -9; j <= 0; ++j) {
        ImuSample sample;
        sample.time = packet.time + Duration::fromSeconds(0.005 * j);
        const double t_s = sample.time.seconds();
        sample.angular_velocity_B = Vec3(0.0, rate_rad_per_s(t_s), 0.0);
        sample.specific_force_B = Vec3(shakes ? 2.0 * std::sin(20.0 * t_s) : 0.0, 0.0, 9.8);
        packet.imu.push_back(sample);
      }
      packet.images = {first[i].clone()};
      if (!second.empty()) packet.images.push_back(second[i].clone());
      references_.push_back(repeats.screen(&packet));
      result.push_back(!packet.images[0].empty());
      if (!second.empty()) second_kept_.push_back(!packet.images[1].empty());
    }
    repeats.finish();
    return result;
  }

  std::string message(const std::string& kind) const {
    for (const Finding& finding : diagnostics_.ranked()) {
      if (finding.kind == kind) return finding.first_message;
    }
    return "no finding of kind " + kind;
  }

  Diagnostics diagnostics_;
  std::vector<ImageRepeats::Reference> references_;
  std::vector<bool> second_kept_;
};

double swaying(double t_s) { return 0.8 * std::sin(3.0 * t_s) + 0.6; }
double resting(double) { return 0.0; }

TEST_F(ImageRepeatsTest, LeavesOutEverySecondImageThatRepeats) {
  std::vector<cv::Mat> images;
  for (int i = 0; i < 40; ++i) images.push_back(picture(i / 2));
  const std::vector<bool> kept_images = kept(images, {}, swaying);
  for (size_t i = 0; i < images.size(); ++i) EXPECT_EQ(kept_images[i], i % 2 == 0) << i;
  EXPECT_EQ(references_[1], ImageRepeats::Reference::Repeat);
  EXPECT_EQ(diagnostics_.count("images_repeated"), 20);
  EXPECT_THAT(message("images_repeated"), HasSubstr("cam0: the image at 0:00.050 (stamp 100050000000 ns)"));
}

TEST_F(ImageRepeatsTest, TellsWhenACameraFroze) {
  std::vector<cv::Mat> images;
  for (int i = 0; i < 40; ++i) images.push_back(picture(i >= 10 && i < 30 ? 9 : i));
  const std::vector<bool> kept_images = kept(images, {}, swaying);
  for (size_t i = 0; i < images.size(); ++i) EXPECT_EQ(kept_images[i], i < 10 || i >= 30) << i;
  EXPECT_EQ(references_[11], ImageRepeats::Reference::Repeat);
  EXPECT_EQ(references_[20], ImageRepeats::Reference::Frozen) << "poses go on";
  EXPECT_EQ(diagnostics_.count("images_frozen"), 1);
  EXPECT_THAT(message("images_frozen"), HasSubstr("cam0: frozen from 0:00.500 to 0:01.450"));
  EXPECT_EQ(diagnostics_.count("images_repeated"), 0);
}

TEST_F(ImageRepeatsTest, OneOfTwoCamerasMayRepeat) {
  std::vector<cv::Mat> left, right;
  for (int i = 0; i < 30; ++i) {
    left.push_back(picture(i));
    right.push_back(picture(i % 5 == 4 ? i - 1 : i));
  }
  const std::vector<bool> left_kept = kept(left, right, swaying);
  for (size_t i = 0; i < left.size(); ++i) {
    EXPECT_TRUE(left_kept[i]) << i;
    EXPECT_EQ(second_kept_[i], i % 5 != 4) << i;
    EXPECT_EQ(references_[i], ImageRepeats::Reference::New) << i;
  }
  EXPECT_THAT(message("images_repeated"), HasSubstr("cam1"));
}

TEST_F(ImageRepeatsTest, KeepsEqualImagesOfARigAtRest) {
  std::vector<cv::Mat> images(30, picture(0));
  for (int i = 0; i < 30; ++i) images.push_back(picture(i + 1));
  const auto rate = [](double t_s) { return t_s < 101.46 ? 0.0 : swaying(t_s); };
  const std::vector<bool> kept_images = kept(images, {}, rate, false);
  // The stationary detector needs some time.
  for (size_t i = 8; i < images.size(); ++i) EXPECT_TRUE(kept_images[i]) << i;
  EXPECT_EQ(diagnostics_.ranked().size(), 0u);
}

TEST_F(ImageRepeatsTest, AFrozenCameraOfARigThatGlidesIsNoRest) {
  std::vector<cv::Mat> images;
  for (int i = 0; i < 60; ++i) images.push_back(picture(std::min(i, 29)));
  const std::vector<bool> kept_images = kept(images, {}, resting, false);
  for (size_t i = 30; i < images.size(); ++i) EXPECT_FALSE(kept_images[i]) << i;
  EXPECT_EQ(diagnostics_.count("images_frozen"), 1);
}

TEST_F(ImageRepeatsTest, RecognizesRepeatsThatWereEncodedOnceMore) {
  std::vector<cv::Mat> images;
  for (int i = 0; i < 60; ++i) images.push_back(i < 20 ? picture(i, 1) : picture(i / 2 + 10, 1 + i % 2));
  const std::vector<bool> kept_images = kept(images, {}, [](double) { return 0.9; });
  for (size_t i = 0; i < images.size(); ++i) EXPECT_EQ(kept_images[i], i <= 20 || i % 2 == 0) << i;
}

TEST_F(ImageRepeatsTest, ATurningPointIsNoRepeat) {
  std::vector<cv::Mat> images;
  for (int i = 0; i < 40; ++i) images.push_back(picture(i == 20 ? 19 : i, 1, i));
  // The gyroscope is also at rest at that moment.
  const auto rate = [](double t_s) { return std::abs(t_s - 101.0) < 0.06 ? 0.0 : 0.9; };
  const std::vector<bool> kept_images = kept(images, {}, rate);
  EXPECT_THAT(kept_images, testing::Each(true));
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(ImageRepeatsTest, BlankImagesAreNamedAsSuchAndStay) {
  std::vector<cv::Mat> images;
  for (int i = 0; i < 30; ++i) {
    images.push_back(i < 10 ? picture(i) : cv::Mat(64, 96, CV_8UC1, cv::Scalar(0)));
  }
  EXPECT_THAT(kept(images, {}, swaying), testing::Each(true));
  EXPECT_EQ(diagnostics_.count("images_blank"), 1);
}

}  // namespace
}  // namespace lodeline
