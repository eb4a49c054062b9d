#include <cmath>

#include "lodeline/cameras/brown_conrady.h"
#include "lodeline/cameras/camera_model.h"
#include "lodeline/cameras/image_place.h"

namespace lodeline {
namespace {

/// Pinhole camera with Brown-Conrady distortion of the plane z = 1 (brown_conrady.h). Valid in front of the
/// camera, within the radius of the distortion.
class RadialTangentialCamera final : public Camera {
 public:
  explicit RadialTangentialCamera(const CameraCalibration& calibration)
      : Camera(calibration), distortion_(calibration.distortion, 0) {}

  std::optional<Vec2> project(const Vec3& point_C, Mat23* pixel_by_point,
                              PixelByParameters* pixel_by_parameters) const override {
    if (!(point_C.z() > 0.0)) return std::nullopt;
    const double inverse_z = 1.0 / point_C.z();
    const Vec2 undistorted = point_C.head<2>() * inverse_z;
    const double max_radius = distortion_.maxRadius();
    if (!(undistorted.squaredNorm() <= max_radius * max_radius)) return std::nullopt;

    Mat2 jacobian;
    const Vec2 distorted = distortion_.distort(undistorted, pixel_by_point ? &jacobian : nullptr);
    const CameraCalibration& c = calibration();
    if (pixel_by_point) {
      Mat23 undistorted_by_point;
      undistorted_by_point << inverse_z, 0.0, -undistorted.x() * inverse_z, 0.0, inverse_z,
          -undistorted.y() * inverse_z;
      pixel_by_point->noalias() = Vec2(c.fx_px, c.fy_px).asDiagonal() * (jacobian * undistorted_by_point);
    }
    if (pixel_by_parameters) {
      setPinholeColumns(c, distorted, pixel_by_parameters);
      const auto count = static_cast<Eigen::Index>(c.distortion.size());
      pixel_by_parameters->rightCols(count) =
          Vec2(c.fx_px, c.fy_px).asDiagonal() * distortion_.byCoefficients(undistorted).leftCols(count);
    }
    return Vec2(c.fx_px * distorted.x() + c.cx_px, c.fy_px * distorted.y() + c.cy_px);
  }

  std::optional<Vec3> unproject(const Vec2& pixel) const override {
    const std::optional<Vec2> undistorted = distortion_.undistort(placeOf(calibration(), pixel));
    if (!undistorted) return std::nullopt;
    return Vec3(undistorted->x(), undistorted->y(), 1.0).normalized();
  }

  double maxAngle_rad() const override { return std::atan(distortion_.maxRadius()); }

 private:
  BrownConrady distortion_;
};

}  // namespace

CameraModel radialTangentialModel() {
  return {
      .name = "radial-tangential",
      .distortions = {"radial-tangential", "radtan", "plumb_bob", "rational_polynomial"},
      .aliases = {"radtan", "plumb_bob", "rational_polynomial", "radialtangential", "radialtangential8",
                  "pinhole-radtan8"},
      .parameters = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"},
      .counts = {4, 5, 8},
      .make = [](const CameraCalibration& c) -> std::shared_ptr<const Camera> {
        return std::make_shared<RadialTangentialCamera>(c);
      },
      .plane = RadialPlane::Tangent,
      .radial_model = "radial-tangential",
      .tangential_at = 2,
      .colmap = {{"OPENCV", 4}, {"FULL_OPENCV", 8}},
      .typical = {0.7, {-0.172, 0.058, 3e-4, -2e-4}},
  };
}

}  // namespace lodeline
