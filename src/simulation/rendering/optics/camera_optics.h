#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lodeline/cameras/camera.h"
#include "simulation/rendering/optics/port_window.h"
#include "simulation/rendering/optics/render_types.h"

namespace lodeline {

/// Optical elements between the water and the image plane.
struct IntrinsicsOptions {
  std::optional<PortWindow> port;  ///< with a port, the calibration describes the camera in air
  double vignetting = 0.35;        ///< attenuation in the image's corners in addition to the cosine law, 0..1
  double blur_sigma_px = 0.55;     ///< point spread function of lens and pixel
};

/// The ray of every pixel of one camera, computed once with the exact inverse of its distortion.
class CameraOptics {
 public:
  CameraOptics(const CameraCalibration& calibration, const IntrinsicsOptions& lens);

  int width() const { return width_; }
  int height() const { return height_; }
  const Rigid3& bodyFromCamera() const { return body_from_camera_; }
  bool sees(int pixel) const { return light_[pixel] > 0.0f; }

  /// Direction of a pixel's ray in the camera frame, unit; valid only where `sees`.
  const Vec3f& direction(int pixel) const { return directions_[pixel]; }
  /// Origin of a pixel's ray in the camera frame, m.
  Vec3f origin(int pixel) const { return origins_.empty() ? Vec3f::Zero() : origins_[pixel]; }

  /// The exact ray of any pixel position, double precision; nothing where there is none.
  std::optional<WaterRay> ray(const Vec2& pixel) const { return ray(pixel, port_); }
  /// The same through another port.
  std::optional<WaterRay> ray(const Vec2& pixel, const std::optional<PortWindow>& port) const;

  /// The exact pixel of a point in the water, by Newton's method on `ray` from the pixel `near`; nothing
  /// where it does not converge.
  std::optional<Vec2> pixelOf(const Vec3& point_C, const Vec2& near) const;

  const std::optional<PortWindow>& port() const { return port_; }

  /// Relative illumination of a pixel compared to the image's centre: natural vignetting, the fourth power of
  /// the cosine to the axis, multiplied by that of the lens.
  float light(int pixel) const { return light_[pixel]; }

  /// Angle between the rays of neighbouring pixels in the image's centre, rad.
  float pixelAngle() const { return pixel_angle_rad_; }

  /// Projects points in the water: exact without a port, the best radial-tangential fit with one.
  const Camera& projector() const { return *projector_; }
  /// Pose of the projector's frame, which a port shifts along the axis.
  const Rigid3& bodyFromProjector() const { return projector_->calibration().body_from_camera; }

  double blurSigma() const { return blur_sigma_px_; }

 private:
  int width_, height_;
  Rigid3 body_from_camera_;
  std::shared_ptr<const Camera> camera_;
  std::shared_ptr<const Camera> projector_;
  std::optional<PortWindow> port_;
  std::vector<Vec3f> directions_;
  std::vector<Vec3f> origins_;  ///< empty without a port
  std::vector<float> light_;
  float pixel_angle_rad_ = 0.0f;
  double blur_sigma_px_;
};

}  // namespace lodeline
