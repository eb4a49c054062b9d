#include "lodeline/mapping/recognition/keypoints/evened_image.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace lodeline {
namespace {

/// Resolution of the evened image at most, px/rad: that of 400 px for 70 degrees.
constexpr double kFocal_px = 290.0;
/// Sigma of the surroundings, 2 degrees.
constexpr double kReach_px = 10.0;
/// What the sensor's noise leaves after smoothing: areas without texture stay plain.
constexpr double kNoise_grey = 2.5;
constexpr double kContrast = 40.0, kMiddle = 128.0;

cv::Mat smoothed(const cv::Mat& values) {
  cv::Mat result;
  cv::GaussianBlur(values, result, {}, kReach_px, kReach_px, cv::BORDER_REFLECT_101);
  return result;
}

}  // namespace

EvenedImage::EvenedImage(const cv::Mat& image, const Camera& camera) {
  const double recorded_px = camera.focalLengthsOnAxis_px().mean();
  cv::Mat values = image;
  if (recorded_px > kFocal_px) {
    const double factor = kFocal_px / recorded_px;
    cv::resize(image, values, {}, factor, factor, cv::INTER_AREA);
    scale = static_cast<double>(values.cols) / image.cols;
  }
  focal_px = scale * recorded_px;
  values.convertTo(values, CV_32F);
  values -= smoothed(values);
  cv::Mat deviation = smoothed(values.mul(values));
  deviation += kNoise_grey * kNoise_grey;
  cv::sqrt(deviation, deviation);
  cv::divide(values, deviation, values);
  values.convertTo(grey, CV_8U, kContrast, kMiddle);
}

}  // namespace lodeline
