#pragma once

#include <opencv2/imgproc.hpp>

#include "lodeline/rig.h"

namespace lodeline::test {

inline constexpr double kWallBaseline_m = 0.12, kWallFocal_px = 250.0;

/// Pinhole cameras of 320x240 px side by side.
inline std::vector<CameraCalibration> wallCameras(size_t count) {
  std::vector<CameraCalibration> cameras(count);
  for (size_t i = 0; i < count; ++i) {
    cameras[i].name = "cam" + std::to_string(i);
    cameras[i].width_px = 320;
    cameras[i].height_px = 240;
    cameras[i].fx_px = cameras[i].fy_px = kWallFocal_px;
    cameras[i].cx_px = 159.5;
    cameras[i].cy_px = 119.5;
    cameras[i].body_from_camera.translation.x() = kWallBaseline_m * static_cast<double>(i);
  }
  return cameras;
}

/// Random texture with details of a few pixels, wider than an image.
inline cv::Mat wallTexture(int seed = 3) {
  cv::RNG random(static_cast<uint64_t>(seed));
  cv::Mat noise(300, 500, CV_8U), texture;
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, texture, {0, 0}, 1.2);
  cv::normalize(texture, texture, 20, 235, cv::NORM_MINMAX);
  return texture;
}

/// What a camera at `x_m` to the right sees of a textured plane z = `depth_m`.
inline cv::Mat planeImage(const cv::Mat& texture, double x_m, double depth_m) {
  const double shift_px = kWallFocal_px * x_m / depth_m;
  const cv::Mat motion = (cv::Mat_<double>(2, 3) << 1, 0, 80 + shift_px, 0, 1, 30);
  cv::Mat image;
  cv::warpAffine(texture, image, motion, {320, 240}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REFLECT);
  return image;
}

}  // namespace lodeline::test
