#include "simulation/rendering/optics/image_sensor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "simulation/rendering/optics/motion_blur.h"

namespace lodeline {
namespace {

/// Uniform light with a signal of `electrons` in 10 ms.
cv::Mat evenLight(const SensorOptions& sensor, double electrons) {
  return cv::Mat(200, 200, CV_32F, cv::Scalar(electrons / sensor.electrons_per_radiance_s / 0.01));
}

TEST(ImageSensor, NoiseIsShotAndReadNoise) {
  SensorOptions sensor;
  sensor.gamma = 1.0;
  for (const double electrons : {1000.0, 3000.0, 6000.0}) {
    const cv::Mat image = develop(evenLight(sensor, electrons), sensor, {0.01, 1.0}, 5);
    cv::Scalar mean, sigma;
    cv::meanStdDev(image, mean, sigma);
    const double per_grey = sensor.full_well_e / 255.0;
    EXPECT_NEAR(mean[0] * per_grey, electrons, 0.01 * electrons + 2.0);
    // Rounding to whole grey values adds a variance of a twelfth.
    const double expected =
        std::sqrt((electrons + sensor.read_noise_e * sensor.read_noise_e) / per_grey / per_grey + 1.0 / 12.0);
    EXPECT_NEAR(sigma[0], expected, 0.05 * expected);
  }
}

TEST(ImageSensor, GainBrightensAndClips) {
  SensorOptions sensor;
  sensor.noise = false;
  const cv::Mat light = evenLight(sensor, 1000.0);
  const int once = develop(light, sensor, {0.01, 1.0}, 1).at<uint8_t>(0, 0);
  EXPECT_EQ(once, std::lround(255.0 * std::pow(0.1, sensor.gamma)));
  EXPECT_GT(develop(light, sensor, {0.01, 4.0}, 1).at<uint8_t>(0, 0), once);
  EXPECT_EQ(develop(light, sensor, {0.01, 12.0}, 1).at<uint8_t>(0, 0), 255);
}

TEST(ImageSensor, MeterReachesItsTargetWithinTheLimits) {
  SensorOptions sensor;
  sensor.noise = false;
  const cv::Mat light = evenLight(sensor, 700.0);
  const double wanted = meteredExposure(sensor, std::vector<float>(9, light.at<float>(0, 0)));
  const cv::Mat image = develop(light, sensor, splitExposure(sensor, wanted), 1);
  EXPECT_NEAR(image.at<uint8_t>(0, 0) / 255.0, sensor.target_grey, 0.01);
  const ExposureSetting dark = splitExposure(sensor, 1e9), bright = splitExposure(sensor, 1e-9);
  EXPECT_EQ(dark.exposure_s, sensor.longest_exposure_s);
  EXPECT_EQ(dark.gain, sensor.highest_gain);
  EXPECT_EQ(bright.exposure_s, sensor.shortest_exposure_s);
  EXPECT_EQ(bright.gain, 1.0);
}

TEST(MotionBlur, TurnSpreadsAPointAlongItsPath) {
  CameraCalibration calibration;
  calibration.width_px = 160;
  calibration.height_px = 120;
  calibration.fx_px = calibration.fy_px = 100.0;
  calibration.cx_px = 80.0;
  calibration.cy_px = 60.0;
  const CameraOptics optics(calibration, IntrinsicsOptions{});
  cv::Mat light(120, 160, CV_32F, cv::Scalar(0)), range(120, 160, CV_32F, cv::Scalar(2.0));
  light.at<float>(60, 80) = 1.0f;
  // Yaw of 0.1 rad during the exposure: ten pixels.
  const auto turned = [](double angle) {
    return Rigid3(Quat(Eigen::AngleAxisd(angle, Vec3::UnitY())), Vec3::Zero());
  };
  blurByMotion(light, range, optics, {turned(-0.05), turned(0.05)});
  EXPECT_NEAR(cv::sum(light)[0], 1.0, 0.1);
  int lit = 0;
  for (int x = 0; x < 160; ++x) lit += light.at<float>(60, x) > 0.02f;
  EXPECT_NEAR(lit, 10, 2);
  EXPECT_GT(cv::sum(light.row(60))[0], 0.99 * cv::sum(light)[0]);
}

}  // namespace
}  // namespace lodeline
