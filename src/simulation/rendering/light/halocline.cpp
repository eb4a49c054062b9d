#include "simulation/rendering/light/halocline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "simulation/rendering/optics/render_types.h"

namespace lodeline {
namespace {

// Sharp, and blurs of these widths; between them, a mixture.
constexpr std::array<double, 4> kSigmas_px = {0.0, 0.9, 2.0, 4.0};
constexpr double kUnseen_m = 10.0;

}  // namespace

double Halocline::saltShare(double height_W_m) const {
  return std::clamp((height_W - height_W_m) / thickness_m + 0.5, 0.0, 1.0);
}

double Halocline::pathWithin(double from_height_m, double to_height_m, double length_m) const {
  const double rise_m = std::abs(to_height_m - from_height_m);
  if (rise_m < 1e-6) {
    const double share = saltShare(from_height_m);
    return share > 0.0 && share < 1.0 ? length_m : 0.0;
  }
  // The share of salt is linear in the height within the layer.
  return std::abs(saltShare(to_height_m) - saltShare(from_height_m)) * thickness_m / rise_m * length_m;
}

void blurByHalocline(cv::Mat& radiance, const cv::Mat& range_m, const cv::Mat& heights_m, double eye_height_m,
                     const Halocline& halocline) {
  const double scale = radiance.cols / 640.0;
  cv::Mat sigma(radiance.size(), CV_32F);
  double greatest = 0.0;
  for (int y = 0; y < radiance.rows; ++y) {
    for (int x = 0; x < radiance.cols; ++x) {
      const double range = std::min<double>(range_m.at<float>(y, x), kUnseen_m);
      const double path = halocline.pathWithin(eye_height_m, heights_m.at<float>(y, x), range);
      // Streaks are independent: the blur grows with the square root beyond half a metre.
      const double blur = halocline.blur_px_per_m * std::min(path, std::sqrt(0.5 * path));
      sigma.at<float>(y, x) = static_cast<float>(std::min(blur, kSigmas_px.back()));
      greatest = std::max(greatest, blur);
    }
  }
  if (greatest < 0.1) return;
  std::array<cv::Mat, kSigmas_px.size()> levels;
  levels[0] = radiance.clone();
  for (size_t k = 1; k < levels.size(); ++k) {
    cv::GaussianBlur(levels[0], levels[k], cv::Size(), scale * kSigmas_px[k]);
  }
  for (int y = 0; y < radiance.rows; ++y) {
    for (int x = 0; x < radiance.cols; ++x) {
      const float wanted = sigma.at<float>(y, x);
      size_t k = 1;
      while (k + 1 < levels.size() && wanted > kSigmas_px[k]) ++k;
      const float t = (wanted - static_cast<float>(kSigmas_px[k - 1])) /
                      static_cast<float>(kSigmas_px[k] - kSigmas_px[k - 1]);
      radiance.at<float>(y, x) = lerp(levels[k - 1].at<float>(y, x), levels[k].at<float>(y, x), t);
    }
  }
}

}  // namespace lodeline
