// Real images (EuRoC MH_01_easy, first 14 s of images) with added image faults. Front end and estimator
// together must continue, stay within their reported covariance, and recover within a second.
// estimator/hard_scenes_test.cpp applies the same faults to tracks of points.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "lodeline/estimator/packet_odometry.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/synchronizer/synchronizer.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/files/test_data.h"

namespace lodeline {
namespace {

constexpr double kBegin_s = 5.0;  // start of the fault, after the first image
constexpr double kEnd_s = 10.0;

/// Adds sensor noise, in grey levels.
void addNoise(double sigma, cv::RNG* random, cv::Mat* image) {
  cv::Mat noise(image->size(), CV_16SC1);
  random->fill(noise, cv::RNG::NORMAL, 0.0, sigma);
  cv::add(*image, noise, *image, cv::noArray(), CV_8U);
}

class HardImages : public testing::TestWithParam<int> {
 protected:
  using Tamper = std::function<void(double time_s, FramePacket& packet)>;

  struct Moment {
    double time_s = 0.0;
    FrameEstimate estimate;
    std::optional<Rigid3> truth;  ///< world_from_body
  };

  void SetUp() override {
    const auto recording = testData(kMh01Recording);
    if (!recording) GTEST_SKIP() << missingTestData(kMh01Recording);
    recording_ = *recording;
    Diagnostics ignored;
    truth_ = readTrajectory(recording_ / "mav0/state_groundtruth_estimate0/gt_tum.txt", {}, ignored);
  }

  void run(const Tamper& tamper) {
    Diagnostics diagnostics;
    EurocOptions options;
    if (GetParam() == 1) options.camera_indices = {0};
    EurocSource source(recording_, options, &diagnostics);
    Synchronizer synchronizer(&source, {}, &diagnostics);
    PacketOdometry odometry(source.rig(), {}, &diagnostics);
    std::optional<Time> first;
    while (auto packet = synchronizer.next()) {
      first = first.value_or(packet->time);
      const double time_s = (packet->time - *first).seconds();
      tamper(time_s, *packet);
      moments_.push_back({time_s, odometry.add(*packet), truthAt(packet->time)});
    }
    EXPECT_EQ(diagnostics.count("solver_failed"), 0);
    ASSERT_GT(moments_.size(), 280u);
  }

  /// Modification of the images from kBegin_s to kEnd_s.
  static Tamper toImages(const std::function<void(double time_s, cv::Mat& image)>& spoil) {
    return [=](double time_s, FramePacket& packet) {
      if (time_s < kBegin_s || time_s >= kEnd_s) return;
      for (cv::Mat& image : packet.images) {
        if (!image.empty()) spoil(time_s, image);
      }
    };
  }

  std::optional<Rigid3> truthAt(Time time) const {
    for (const StampedPose& pose : truth_.poses) {
      if (std::abs((pose.time - time).seconds()) < 0.01) return pose.world_from_body;
    }
    return std::nullopt;
  }

  /// Compares the motion since the start of the fault with the true one, in the body at that time. Limits:
  /// `limit_m` and four times the reported sigma, from the positions then and now and from the attitude at
  /// the start.
  void expectDriftWithin(double limit_m) const {
    const Moment* start = nullptr;
    double worst_m = 0.0;
    double worst_sigmas = 0.0;
    for (const Moment& now : moments_) {
      if (now.time_s < kBegin_s - 0.1 || !now.truth) continue;
      ASSERT_NE(now.estimate.status, Status::Waiting) << "at " << now.time_s << " s";
      if (!start) start = &now;
      const Vec3 moved =
          (start->estimate.state.world_from_body.inverse() * now.estimate.state.world_from_body).translation;
      const Vec3 truly = (start->truth->inverse() * *now.truth).translation;
      const double error_m = (moved - truly).norm();
      const auto variance = [](const Moment& moment, int first) {
        return moment.estimate.covariance.diagonal().segment<3>(first).sum();
      };
      const double sigma_m =
          std::sqrt(variance(now, 0) + variance(*start, 0) + variance(*start, 3) * truly.squaredNorm());
      worst_m = std::max(worst_m, error_m);
      worst_sigmas = std::max(worst_sigmas, error_m / sigma_m);
    }
    EXPECT_LT(worst_sigmas, 4.0);
    EXPECT_LT(worst_m, limit_m);
    RecordProperty("drift_mm", static_cast<int>(1000.0 * worst_m));
    RecordProperty("drift_percent_of_sigma", static_cast<int>(100.0 * worst_sigmas));
  }
  void expectTracking(double from_s, double to_s) const {
    for (const Moment& now : moments_) {
      if (now.time_s < from_s || now.time_s >= to_s) continue;
      EXPECT_EQ(now.estimate.status, Status::Tracking) << "at " << now.time_s << " s";
    }
  }

  std::filesystem::path recording_;
  Trajectory truth_;
  std::vector<Moment> moments_;
};

TEST_P(HardImages, BlackForFiveSeconds) {
  run(toImages([](double, cv::Mat& image) { image = cv::Mat::zeros(image.size(), image.type()); }));
  expectTracking(kEnd_s + 1.0, 20.0);
  expectDriftWithin(0.8);  // dead reckoning: 5 cm/s^2 for that time
}

// Silt: the view fades to grey and back, with sensor noise.
TEST_P(HardImages, SiltComesAndGoes) {
  cv::RNG random(7);
  run(toImages([&](double time_s, cv::Mat& image) {
    const double clear = std::abs(time_s - 0.5 * (kBegin_s + kEnd_s)) / (0.5 * (kEnd_s - kBegin_s));
    const double contrast = clear * clear * clear;
    image.convertTo(image, CV_8U, contrast, 110.0 * (1.0 - contrast));
    addNoise(3.0, &random, &image);
  }));
  expectTracking(kEnd_s + 1.0, 20.0);
  expectDriftWithin(0.5);
}

// Silt too dense to see through, full of particles in the lamp's light, with other particles in every image.
TEST_P(HardImages, NothingButParticles) {
  cv::RNG random(11);
  run(toImages([&](double, cv::Mat& image) {
    image.setTo(30.0);
    for (int i = 0; i < 150; ++i) {
      const cv::Point centre(random.uniform(0, image.cols), random.uniform(0, image.rows));
      cv::circle(image, centre, random.uniform(2, 7), random.uniform(60.0, 200.0), cv::FILLED);
    }
    cv::GaussianBlur(image, image, {}, 1.5);
  }));
  expectTracking(kEnd_s + 1.0, 20.0);
  expectDriftWithin(0.8);
}

// Silt in a compressed video: only the edges of its blocks are visible.
TEST_P(HardImages, NothingButBlocksOfAVideo) {
  cv::RNG random(13);
  run(toImages([&](double, cv::Mat& image) {
    image.convertTo(image, CV_8U, 0.03, 100.0);
    addNoise(2.0, &random, &image);
    std::vector<unsigned char> compressed;
    cv::imencode(".jpg", image, compressed, {cv::IMWRITE_JPEG_QUALITY, 30});
    image = cv::imdecode(compressed, cv::IMREAD_GRAYSCALE);
  }));
  expectTracking(kEnd_s + 1.0, 20.0);
  expectDriftWithin(0.8);
}

TEST_P(HardImages, FortyOfAHundredFramesMissing) {
  cv::RNG random(3);
  run([&](double time_s, FramePacket& packet) {
    if (time_s < kBegin_s || random.uniform(0.0, 1.0) > 0.4) return;
    for (cv::Mat& image : packet.images) image = cv::Mat();
  });
  expectDriftWithin(0.1);
}

// A lamp that is switched, and a camera whose exposure follows with a delay.
TEST_P(HardImages, ExposureJumps) {
  run(toImages([](double time_s, cv::Mat& image) {
    const double since_s = std::fmod(time_s - kBegin_s, 0.75);
    const bool brighter = static_cast<int>((time_s - kBegin_s) / 0.75) % 2 == 0;
    const double gain = std::pow(brighter ? 2.5 : 0.3, std::exp(-since_s / 0.3));
    image.convertTo(image, CV_8U, gain);
  }));
  expectTracking(kBegin_s, 20.0);
  expectDriftWithin(0.1);
}

// A hand with the texture of the walls moves up and down in front of half of the view.
TEST_P(HardImages, AHandBeforeTheLens) {
  run(toImages([](double time_s, cv::Mat& image) {
    const int width = image.cols / 2;
    const int height = image.rows * 2 / 3;
    const double share = 0.5 + 0.5 * std::sin(4.0 * (time_s - kBegin_s));
    const cv::Mat hand = image(cv::Rect(0, 0, width, height)).clone();
    cv::flip(hand,
             image(cv::Rect(image.cols / 4, static_cast<int>(share * (image.rows - height)), width, height)),
             1);
  }));
  expectTracking(kBegin_s, 20.0);
  expectDriftWithin(0.15);
}

// Milky water: a quarter of the contrast, blurred, with noise.
TEST_P(HardImages, MilkyWater) {
  cv::RNG random(5);
  run(toImages([&](double, cv::Mat& image) {
    cv::GaussianBlur(image, image, {}, 1.5);
    image.convertTo(image, CV_8U, 0.25, 100.0);
    addNoise(2.0, &random, &image);
  }));
  expectTracking(kBegin_s, 20.0);
  expectDriftWithin(0.1);
}

INSTANTIATE_TEST_SUITE_P(StereoAndMono, HardImages, testing::Values(2, 1),
                         [](const auto& info) { return info.param == 2 ? "Stereo" : "Mono"; });

}  // namespace
}  // namespace lodeline
