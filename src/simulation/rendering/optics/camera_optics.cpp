#include "simulation/rendering/optics/camera_optics.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "simulation/rendering/optics/port_fit.h"

namespace lodeline {

CameraOptics::CameraOptics(const CameraCalibration& calibration, const IntrinsicsOptions& lens)
    : width_(calibration.width_px),
      height_(calibration.height_px),
      body_from_camera_(calibration.body_from_camera),
      camera_(makeCamera(calibration)),
      projector_(lens.port ? makeCamera(fitRadialTangential(calibration, *lens.port).calibration) : camera_),
      port_(lens.port),
      blur_sigma_px_(lens.blur_sigma_px) {
  const size_t count = static_cast<size_t>(width_) * height_;
  directions_.assign(count, Vec3f::UnitZ());
  light_.assign(count, 0.0f);
  if (port_) origins_.assign(count, Vec3f::Zero());
  const double corner2 = 0.25 * (width_ * width_ + height_ * height_);
  tbb::parallel_for(0, height_, [&](int y) {
    for (int x = 0; x < width_; ++x) {
      const auto traced = ray(Vec2(x, y));
      if (!traced) continue;
      const size_t pixel = static_cast<size_t>(y) * width_ + x;
      directions_[pixel] = traced->direction_C.cast<float>();
      if (port_) origins_[pixel] = traced->origin_C.cast<float>();
      const double dx = x - 0.5 * (width_ - 1), dy = y - 0.5 * (height_ - 1);
      const double off_centre = (dx * dx + dy * dy) / corner2;
      light_[pixel] = static_cast<float>(std::pow(traced->direction_C.z(), 4.0) *
                                         (1.0 - lens.vignetting * off_centre * off_centre));
    }
  });
  const double fx_water = camera_->focalLengthsOnAxis_px().x() * (port_ ? enlargementBy(*port_) : 1.0);
  pixel_angle_rad_ = static_cast<float>(1.0 / fx_water);
}

std::optional<WaterRay> CameraOptics::ray(const Vec2& pixel, const std::optional<PortWindow>& port) const {
  const auto direction = camera_->unproject(pixel);
  if (!direction || direction->z() <= 0.0) return std::nullopt;
  if (!port) return WaterRay{Vec3::Zero(), *direction};
  return throughPort(*port, *direction);
}

std::optional<Vec2> CameraOptics::pixelOf(const Vec3& point_C, const Vec2& near) const {
  // Where the ray of a pixel passes the plane of the point, relative to the point.
  const auto miss = [&](const Vec2& pixel) -> std::optional<Vec2> {
    const auto traced = ray(pixel);
    if (!traced) return std::nullopt;
    const double along = (point_C.z() - traced->origin_C.z()) / traced->direction_C.z();
    return Vec2((traced->origin_C + along * traced->direction_C - point_C).head<2>());
  };
  Vec2 pixel = near;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const auto here = miss(pixel);
    const auto right = miss(pixel + Vec2(0.01, 0.0)), below = miss(pixel + Vec2(0.0, 0.01));
    if (!here || !right || !below) return std::nullopt;
    Eigen::Matrix2d slope;
    slope << 100.0 * (*right - *here), 100.0 * (*below - *here);
    const Vec2 step = slope.inverse() * *here;
    pixel -= step;
    if (step.norm() < 1e-9) return pixel;
    if (!pixel.allFinite()) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace lodeline
