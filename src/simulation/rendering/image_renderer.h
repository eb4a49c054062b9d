#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "lodeline/sensors/rig.h"
#include "simulation/rendering/light/light_meter.h"
#include "simulation/rendering/light/render_settings.h"
#include "simulation/rendering/light/render_world.h"

namespace lodeline {

/// Renders what a rig's cameras record in a world. All effects are functions of the settings, the motion and
/// the time alone: images can be made in any order, by any number of threads at once, with the same bytes.
/// The motion is asked for times around the exposure and for the three time constants of the automatic
/// exposure before it: it must hold its first pose where the dive has not begun.
class ImageRenderer {
 public:
  /// `true_rig` holds the cameras as they really are; with a flat port their intrinsics are those in air.
  ImageRenderer(std::shared_ptr<const RenderWorld> world, const Rig& true_rig,
                const RenderSettings& settings);

  /// One image (CV_8UC1) exposed symmetrically about `middle_s`; with a rolling shutter, that is the middle
  /// of the centre row.
  cv::Mat render(int camera, const WorldFromBodyAt& motion, double middle_s) const;

  /// What the automatic exposure has settled on at that time.
  ExposureSetting exposure(int camera, const WorldFromBodyAt& motion, double middle_s) const {
    return meter_.exposure(optics_[camera], motion, middle_s);
  }

  /// Distance to the first surface along a unit direction, m: what a sonar or a landmark sees.
  std::optional<double> range(const Vec3& origin_W, const Vec3& direction_W) const {
    return world_->scene.range(origin_W, direction_W);
  }

  /// World point that a pixel position sees from a true body pose, traced exactly.
  std::optional<Vec3> hitPoint(int camera, const Vec2& pixel, const Rigid3& world_from_body) const;

  const CameraOptics& optics(int camera) const { return optics_[camera]; }
  const RenderSettings& settings() const { return settings_; }

 private:
  /// Light before the sensor, and how far it came.
  struct Light {
    cv::Mat radiance;  ///< CV_32F, vignetted
    cv::Mat range_m;   ///< CV_32F, infinite where nothing was met
  };

  Light trace(int camera, const WorldFromBodyAt& motion, double middle_s, const LightField& light) const;
  std::shared_ptr<const RenderWorld> world_;
  RenderSettings settings_;
  LightMeter meter_;
  std::vector<CameraOptics> optics_;
};

}  // namespace lodeline
