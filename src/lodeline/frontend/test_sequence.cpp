#include "lodeline/frontend/test_sequence.h"

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

constexpr double kWallDistance_m = 2.0;
constexpr double kTexelsPerMetre = 300.0;
constexpr int kTextureSide = 1600;

/// Uniform in [-1, 1], the same on every machine.
float uniform(std::mt19937& random) { return static_cast<float>(random()) * 4.656612873e-10F - 1.0F; }

/// Noise with detail at several scales, mean 1 and the given standard deviation.
cv::Mat rockTexture(double contrast) {
  std::mt19937 random(7);
  cv::Mat texture(kTextureSide, kTextureSide, CV_32F, cv::Scalar(0.0));
  for (const int grain : {4, 8, 16, 32, 64, 128}) {
    cv::Mat coarse(kTextureSide / grain + 2, kTextureSide / grain + 2, CV_32F);
    for (int y = 0; y < coarse.rows; ++y) {
      for (int x = 0; x < coarse.cols; ++x) coarse.at<float>(y, x) = uniform(random);
    }
    cv::Mat octave;
    cv::resize(coarse, octave, texture.size(), 0.0, 0.0, cv::INTER_CUBIC);
    texture += std::sqrt(static_cast<double>(grain)) * octave;
  }
  cv::Scalar mean, deviation;
  cv::meanStdDev(texture, mean, deviation);
  return 1.0 + (texture - mean[0]) * (contrast / deviation[0]);
}

CameraCalibration cameraAt(const std::string& name, double x_m) {
  CameraCalibration c;
  c.name = name;
  c.width_px = 752;
  c.height_px = 480;
  c.fx_px = c.fy_px = 458.0;
  c.cx_px = 375.5;
  c.cy_px = 239.5;
  c.model = "none";
  c.rate_hz = TestSequence::kRateHz;
  c.body_from_camera.translation = Vec3(x_m, 0.0, 0.0);
  return c;
}

Vec3 ray(const CameraCalibration& c, const Vec2& pixel) {
  return {(pixel.x() - c.cx_px) / c.fx_px, (pixel.y() - c.cy_px) / c.fy_px, 1.0};
}

}  // namespace

TestSequence::TestSequence(const TestLight& light, double speed_m_per_s)
    : light_(light), speed_m_per_s_(speed_m_per_s), texture_(rockTexture(light.texture_contrast)) {
  rig_.cameras = {cameraAt("cam0", 0.0), cameraAt("cam1", 0.11)};
}

Rigid3 TestSequence::worldFromBody(int frame) const {
  // The body, which is camera 0, looks along z at the wall z = kWallDistance_m and sways while it swims.
  const double t = frame / kRateHz, w = 2.0 * std::numbers::pi * 0.5;
  const double sway = speed_m_per_s_ > 0.0 ? 1.0 : 0.0;
  const Vec3 turn(0.03 * std::sin(w * t), 0.04 * std::sin(0.7 * w * t), 0.05 * std::sin(0.9 * w * t));
  return {so3::exp(sway * turn),
          Vec3(speed_m_per_s_ * t, sway * 0.05 * std::sin(w * t), 0.1 * speed_m_per_s_ * t)};
}

Quat TestSequence::previousFromCurrent(int frame) const {
  return worldFromBody(frame - 1).rotation.conjugate() * worldFromBody(frame).rotation;
}

Rigid3 TestSequence::worldFromCamera(int frame, int camera) const {
  return worldFromBody(frame) * rig_.cameras[static_cast<size_t>(camera)].body_from_camera;
}

std::optional<Vec3> TestSequence::wallPoint(int frame, int camera, const Vec2& pixel) const {
  const Rigid3 world_from_camera = worldFromCamera(frame, camera);
  const Vec3 direction = world_from_camera.rotation * ray(rig_.cameras[static_cast<size_t>(camera)], pixel);
  if (direction.z() <= 0.0) return std::nullopt;
  const double distance = (kWallDistance_m - world_from_camera.translation.z()) / direction.z();
  return world_from_camera.translation + distance * direction;
}

std::optional<Vec2> TestSequence::truePixel(int frame, int camera, const Vec2& pixel, int other_frame,
                                            int other_camera) const {
  const auto point = wallPoint(frame, camera, pixel);
  if (!point) return std::nullopt;
  const Vec3 seen = worldFromCamera(other_frame, other_camera).inverse() * *point;
  if (seen.z() <= 0.0) return std::nullopt;
  const CameraCalibration& c = rig_.cameras[static_cast<size_t>(other_camera)];
  return Vec2(c.fx_px * seen.x() / seen.z() + c.cx_px, c.fy_px * seen.y() / seen.z() + c.cy_px);
}

float TestSequence::albedo(double x_m, double y_m) const {
  const double x = x_m * kTexelsPerMetre + 0.5 * kTextureSide, y = y_m * kTexelsPerMetre + 0.5 * kTextureSide;
  const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  if (column < 0 || row < 0 || column + 1 >= kTextureSide || row + 1 >= kTextureSide) return 1.0F;
  const auto fx = static_cast<float>(x - column), fy = static_cast<float>(y - row);
  const auto* upper = texture_.ptr<float>(row) + column;
  const auto* lower = texture_.ptr<float>(row + 1) + column;
  return (1.0F - fy) * ((1.0F - fx) * upper[0] + fx * upper[1]) +
         fy * ((1.0F - fx) * lower[0] + fx * lower[1]);
}

std::vector<cv::Mat> TestSequence::images(int frame) const {
  std::vector<cv::Mat> result;
  for (int camera = 0; camera < static_cast<int>(rig_.cameras.size()); ++camera) {
    const CameraCalibration& c = rig_.cameras[static_cast<size_t>(camera)];
    std::mt19937 random(static_cast<uint32_t>(1000 * frame + camera));
    cv::Mat image(c.height_px, c.width_px, CV_8U);
    for (int y = 0; y < c.height_px; ++y) {
      for (int x = 0; x < c.width_px; ++x) {
        const auto point = wallPoint(frame, camera, Vec2(x, y));
        const double dx = (x - 330.0) / light_.lamp_radius_px, dy = (y - 270.0) / light_.lamp_radius_px;
        const double pool = std::exp(-0.5 * (dx * dx + dy * dy));
        const double light = light_.ambient_grey + light_.lamp_grey * pool;
        const double grey = light * (point ? albedo(point->x(), point->y()) : 1.0F) + light_.haze_grey * pool;
        // The sum of four uniform numbers is approximately normal; its standard deviation is 2 / sqrt(3).
        const double noise = uniform(random) + uniform(random) + uniform(random) + uniform(random);
        image.at<uint8_t>(y, x) =
            cv::saturate_cast<uint8_t>(grey + light_.noise_grey * 0.5 * std::numbers::sqrt3 * noise);
      }
    }
    result.push_back(image);
  }
  return result;
}

}  // namespace lodeline
