#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "simulation/rendering/light/light_field.h"
#include "simulation/rendering/light/render_settings.h"
#include "simulation/rendering/light/render_world.h"

namespace lodeline {

/// True pose of the body at a time of the dive (s).
using WorldFromBodyAt = std::function<Rigid3(double time_s)>;

/// The automatic exposure: a few hundred rays measure the light, a first-order lag in its logarithm follows
/// it. The lag is written out over the recent past instead of carried from image to image, so that any image
/// can be made on its own, in any order. Measurements stand on a grid of time and are remembered, as
/// neighbouring images share most of them. Safe to share between threads.
class LightMeter {
 public:
  LightMeter(std::shared_ptr<const RenderWorld> world, const RenderSettings& settings)
      : world_(std::move(world)), settings_(settings) {}

  /// What the exposure of a camera has settled on.
  ExposureSetting exposure(const CameraOptics& optics, const WorldFromBodyAt& motion, double time_s) const;

 private:
  /// Exposure time at gain 1 for a pose, remembered.
  double wantedExposure(const CameraOptics& optics, const Rigid3& world_from_body, double time_s) const;
  std::vector<float> measure(const CameraOptics& optics, const Rigid3& world_from_body, double time_s) const;

  std::shared_ptr<const RenderWorld> world_;
  RenderSettings settings_;
  /// By a hash of camera, pose and time: a memory of a pure function, which no result can depend on.
  mutable std::map<uint64_t, double> remembered_;
  mutable std::mutex mutex_;
};

}  // namespace lodeline
