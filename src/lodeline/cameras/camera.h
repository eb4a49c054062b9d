#pragma once

#include <memory>
#include <optional>

#include "lodeline/rig.h"

namespace lodeline {

struct CameraModel;

/// Derivative of a pixel by the parameters of its camera: fx, fy, cx, cy, then CameraCalibration::distortion.
using PixelByParameters = Eigen::Matrix<double, 2, Eigen::Dynamic>;

/// Line on which the points of a pixel lie, in C.
struct ViewRay {
  Vec3 origin_C = Vec3::Zero();      ///< the lens centre; behind a port the point of the outer face, m
  Vec3 direction_C = Vec3::UnitZ();  ///< unit, in the water

  /// The same line, with its point next to the lens centre as origin.
  ViewRay fromNearestPoint() const {
    return {origin_C - origin_C.dot(direction_C) * direction_C, direction_C};
  }
};

/// Projects points of the camera frame C (z forward, x right, y down; m) to pixels and back. Implementations
/// are immutable, so threads can share them.
class Camera {
 public:
  /// Distance of the points for which a direction alone is exact behind a port.
  static constexpr double kNominalDistance_m = 1.0;

  explicit Camera(const CameraCalibration& calibration);
  virtual ~Camera() = default;

  /// Pixel of a point and, where requested, its derivative by the point (2x3, px/m) and by the parameters.
  /// Returns nothing where the model is invalid: at the centre, behind the camera, or beyond maxAngle_rad().
  /// The pixel may be outside the image.
  virtual std::optional<Vec2> project(const Vec3& point_C, Mat23* pixel_by_point = nullptr,
                                      PixelByParameters* pixel_by_parameters = nullptr) const = 0;

  /// Unit viewing ray of a pixel in C, exact to 1e-10 rad. Returns nothing outside the range of the model.
  /// Behind a port, the lines of the pixels have no common point. The ray is then that from the lens centre
  /// to the point of the line at kNominalDistance_m from that centre.
  virtual std::optional<Vec3> unproject(const Vec2& pixel) const = 0;

  /// Line of a pixel, exact at every distance.
  virtual std::optional<ViewRay> viewRay(const Vec2& pixel) const;

  /// Pixel of the point `point_C` / `inverse_scale`. An inverse scale of zero is a point at infinity.
  virtual std::optional<Vec2> projectHomogeneous(const Vec3& point_C, double inverse_scale) const;

  /// Largest angle to the optical axis at which the model is valid, rad. Up to it the distance of the pixel
  /// from the principal point grows with the angle.
  virtual double maxAngle_rad() const = 0;

  /// Derivative of the pixel by the angle to the optical axis, on the axis; along u and along v, px/rad.
  Vec2 focalLengthsOnAxis_px() const;

  /// Whether a pixel is in the image and at least `border_px` from its edges.
  bool contains(const Vec2& pixel, double border_px = 0.0) const {
    return pixel.x() >= border_px && pixel.y() >= border_px &&
           pixel.x() <= calibration_.width_px - 1 - border_px &&
           pixel.y() <= calibration_.height_px - 1 - border_px;
  }

  const CameraCalibration& calibration() const { return calibration_; }
  const CameraModel& model() const { return *model_; }

 private:
  CameraCalibration calibration_;
  const CameraModel* model_;
};

/// Creates the camera of a calibration by the model that it names. Throws InputError for an unknown model and
/// for invalid parameters.
std::shared_ptr<const Camera> makeCamera(const CameraCalibration& calibration);

}  // namespace lodeline
