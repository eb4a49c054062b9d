#include "lodeline/mapping/recognition/keypoints/evened_image.h"

#include <algorithm>
#include <cstdlib>
#include <opencv2/imgproc.hpp>

namespace lodeline {
namespace {
}  // namespace

EvenedImage::EvenedImage(const cv::Mat& image, const Camera& camera) {
  static const double kFocal_px = env("R_F", 290.0);
  static const double kReach_px = env("R_REACH", 10.0);
  static const double kNoise_grey = env("R_NOISE", 2.5);
  const double focal_px = camera.focalLengthsOnAxis_px().mean();
  scale = std::min(1.0, kFocal_px / focal_px);
  cv::Mat values, mean, variance;
  if (scale < 1.0) {
    cv::resize(image, values, {}, scale, scale, cv::INTER_AREA);
    scale = static_cast<double>(values.cols) / image.cols;
    values.convertTo(values, CV_32F);
  } else {
    image.convertTo(values, CV_32F);
  }
  cv::GaussianBlur(values, mean, {}, kReach_px, kReach_px, cv::BORDER_REFLECT_101);
  values -= mean;
  cv::GaussianBlur(values.mul(values), variance, {}, kReach_px, kReach_px, cv::BORDER_REFLECT_101);
  variance += kNoise_grey * kNoise_grey;
  cv::sqrt(variance, variance);
  cv::divide(values, variance, values);
  values.convertTo(grey, CV_8U, 40.0, 128.0);
}

}  // namespace lodeline
