#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "lodeline/rig.h"
#include "simulation/rendering/light/light_meter.h"
#include "simulation/rendering/light/render_settings.h"
#include "simulation/rendering/light/render_world.h"
#include "simulation/rendering/optics/dispersion.h"

namespace lodeline {

/// Renders the images of a rig's cameras in a world. All effects are functions of the settings, the motion
/// and the time alone. Any number of threads can therefore render the images in any order with the same
/// bytes. The motion must be defined around the exposure and for three time constants of the automatic
/// exposure before it; before the dive it must return its first pose.
class ImageRenderer {
 public:
  /// `true_rig` contains the true cameras; with a flat port, their intrinsics are those in air.
  ImageRenderer(std::shared_ptr<const RenderWorld> world, const Rig& true_rig,
                const RenderSettings& settings);

  /// Renders one image (CV_8UC1) exposed symmetrically about `middle_s`; with a rolling shutter, that is the
  /// middle of the centre row.
  cv::Mat render(int camera, const WorldFromBodyAt& motion, double middle_s) const;

  /// Setting of the automatic exposure at that time.
  ExposureSetting exposure(int camera, const WorldFromBodyAt& motion, double middle_s) const {
    return meter_.exposure(optics_[camera], motion, middle_s);
  }

  /// Distance to the first surface along a unit direction, m, for sonar and landmarks.
  std::optional<double> range(const Vec3& origin_W, const Vec3& direction_W) const {
    return world_->scene.range(origin_W, direction_W);
  }

  /// World point at a pixel position for a true body pose, traced exactly.
  std::optional<Vec3> hitPoint(int camera, const Vec2& pixel, const Rigid3& world_from_body) const;

  const CameraOptics& optics(int camera) const { return optics_[camera]; }
  const RenderSettings& settings() const { return settings_; }

 private:
  /// Light before the sensor, and the distance to its origin.
  struct Light {
    cv::Mat radiance;  ///< CV_32F, vignetted
    cv::Mat range_m;   ///< CV_32F, infinite without a surface
    cv::Mat height_W;  ///< CV_32F, of the point in view, m; empty without a halocline
  };

  /// Rays of one camera in the water about it.
  struct CameraInWater {
    const CameraOptics* optics;
    std::shared_ptr<const CameraOptics> kept;  ///< owns the optics within a halocline
  };
  CameraInWater inWater(int camera, const Rigid3& world_from_body) const;

  /// Poses of the body while each row is exposed; nothing for a global shutter.
  std::vector<Rigid3> rowPoses(const CameraOptics& optics, const WorldFromBodyAt& motion,
                               double middle_s) const;

  Light trace(const CameraOptics& optics, const Rigid3& world_from_body, const std::vector<Rigid3>& row_poses,
              const LightField& light) const;
  std::shared_ptr<const RenderWorld> world_;
  RenderSettings settings_;
  LightMeter meter_;
  std::vector<CameraOptics> optics_;       ///< in the water of the port; above a halocline
  std::vector<CameraOptics> salt_optics_;  ///< below a halocline; empty without one
  std::vector<Dispersion> dispersion_;     ///< empty without dispersion
  std::vector<CameraCalibration> cameras_;
};

}  // namespace lodeline
