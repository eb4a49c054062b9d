#include <cmath>
#include <numbers>

#include "lodeline/cameras/camera_model.h"
#include "lodeline/cameras/image_place.h"

namespace lodeline {
namespace {

/// Ideal pinhole camera: the pixel is (fx x / z + cx, fy y / z + cy). Valid to 89.5 degrees off the axis.
class PinholeCamera final : public Camera {
 public:
  using Camera::Camera;

  std::optional<Vec2> project(const Vec3& point_C, Mat23* pixel_by_point,
                              PixelByParameters* pixel_by_parameters) const override {
    if (!(point_C.z() > 0.0)) return std::nullopt;
    const double inverse_z = 1.0 / point_C.z();
    const Vec2 place = point_C.head<2>() * inverse_z;
    if (!(place.squaredNorm() <= max_radius_ * max_radius_)) return std::nullopt;
    const CameraCalibration& c = calibration();
    if (pixel_by_point) {
      *pixel_by_point << c.fx_px * inverse_z, 0.0, c.fx_px * (-place.x() * inverse_z), 0.0,
          c.fy_px * inverse_z, c.fy_px * (-place.y() * inverse_z);
    }
    if (pixel_by_parameters) setPinholeColumns(c, place, pixel_by_parameters);
    return Vec2(c.fx_px * place.x() + c.cx_px, c.fy_px * place.y() + c.cy_px);
  }

  std::optional<Vec3> unproject(const Vec2& pixel) const override {
    const Vec2 place = placeOf(calibration(), pixel);
    if (!(place.squaredNorm() <= max_radius_ * max_radius_)) return std::nullopt;
    return Vec3(place.x(), place.y(), 1.0).normalized();
  }

  double maxAngle_rad() const override { return kMaxAngle_rad; }

 private:
  static constexpr double kMaxAngle_rad = 89.5 * std::numbers::pi / 180.0;
  double max_radius_ = std::tan(kMaxAngle_rad);
};

}  // namespace

CameraModel pinholeModel() {
  return {
      .name = "none",
      .aliases = {"pinhole", "PINHOLE", "PinHole", "Rectified"},
      .make = [](const CameraCalibration& c) -> std::shared_ptr<const Camera> {
        return std::make_shared<PinholeCamera>(c);
      },
      .plane = RadialPlane::Tangent,
      .radial_model = "radial-tangential",
      .colmap = {{"PINHOLE", 0}},
      .typical = {0.7, {}},
  };
}

}  // namespace lodeline
