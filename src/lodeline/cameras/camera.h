#pragma once

#include <memory>
#include <optional>

#include "lodeline/rig.h"

namespace lodeline {

/// Projects points of the camera frame C (z forward, x right, y down; m) to pixels and back. Implementations
/// are immutable, so threads can share them.
class Camera {
 public:
  explicit Camera(const CameraCalibration& calibration) : calibration_(calibration) {}
  virtual ~Camera() = default;

  /// Pixel of a point and, where requested, the 2x3 derivative of the pixel by the point (px/m). Returns
  /// nothing where the model is invalid: behind the camera, or beyond the angle up to which the distortion
  /// grows monotonically. The pixel may be outside the image.
  virtual std::optional<Vec2> project(const Vec3& point_C, Mat23* pixel_by_point = nullptr) const = 0;

  /// Unit viewing ray of a pixel in C, exact to 1e-10 rad. Returns nothing outside the range of the model.
  virtual std::optional<Vec3> unproject(const Vec2& pixel) const = 0;

  /// Whether a pixel is in the image and at least `border_px` from its edges.
  bool contains(const Vec2& pixel, double border_px = 0.0) const {
    return pixel.x() >= border_px && pixel.y() >= border_px &&
           pixel.x() <= calibration_.width_px - 1 - border_px &&
           pixel.y() <= calibration_.height_px - 1 - border_px;
  }

  const CameraCalibration& calibration() const { return calibration_; }

 private:
  CameraCalibration calibration_;
};

/// Creates the camera model named by a calibration. Throws InputError where the parameters are invalid.
std::shared_ptr<const Camera> makeCamera(const CameraCalibration& calibration);

}  // namespace lodeline
