#include "simulation/rendering/optics/motion_blur.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "simulation/rendering/optics/sampling.h"

namespace lodeline {
namespace {

constexpr float kUnseenRange_m = 30.0f;

}  // namespace

void blurByMotion(cv::Mat& radiance, const cv::Mat& range_m, const CameraOptics& optics,
                  const ExposureMotion& motion) {
  const Mat3f start_R = motion.start_from_middle.rotation.toRotationMatrix().cast<float>();
  const Mat3f end_R = motion.end_from_middle.rotation.toRotationMatrix().cast<float>();
  const Vec3f start_t = motion.start_from_middle.translation.cast<float>();
  const Vec3f end_t = motion.end_from_middle.translation.cast<float>();
  const Mat3f delta_R = end_R - start_R;
  const Vec3f delta_t = end_t - start_t;
  const float focal_px = 1.0f / optics.pixelAngle();
  const cv::Mat sharp = radiance.clone();
  tbb::parallel_for(0, radiance.rows, [&](int y) {
    const float* ranges = range_m.ptr<float>(y);
    float* out = radiance.ptr<float>(y);
    for (int x = 0; x < radiance.cols; ++x) {
      const int pixel = y * radiance.cols + x;
      const Vec3f& ray = optics.direction(pixel);
      const Vec3f point = std::min(ranges[x], kUnseenRange_m) * ray;
      // For small motion, the pinhole's derivative at the ray is sufficient; distortion changes the streak's
      // length by only a few per cent.
      const Vec3f moved = delta_R * point + delta_t;
      const float per_z = focal_px / point.z();
      const float dx = per_z * (moved.x() - point.x() / point.z() * moved.z());
      const float dy = per_z * (moved.y() - point.y() / point.z() * moved.z());
      const float length = std::min(40.0f, std::sqrt(dx * dx + dy * dy));
      if (length < 0.5f) continue;  // less than the blur of the lens
      const int taps = std::min(17, 2 + static_cast<int>(length));
      float sum = 0.0f;
      for (int k = 0; k < taps; ++k) {
        const float at = (k + 0.5f) / taps - 0.5f;
        sum += bilinear(sharp, x + at * dx, y + at * dy);
      }
      out[x] = sum / taps;
    }
  });
}

}  // namespace lodeline
