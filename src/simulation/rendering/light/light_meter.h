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

/// Automatic exposure: a few hundred rays measure the light, and a first-order lag in its logarithm follows
/// it. The lag is evaluated over the recent past, so that images can be rendered separately and in any order.
/// Measurements are made on a grid of times and cached, because neighbouring images share most of them. Safe
/// to share between threads.
class LightMeter {
 public:
  LightMeter(std::shared_ptr<const RenderWorld> world, const RenderSettings& settings)
      : world_(std::move(world)), settings_(settings) {}

  /// Exposure setting of a camera.
  ExposureSetting exposure(const CameraOptics& optics, const WorldFromBodyAt& motion, double time_s) const;

 private:
  /// Exposure time at gain 1 for a pose, cached.
  double wantedExposure(const CameraOptics& optics, const Rigid3& world_from_body, double time_s) const;
  std::vector<float> measure(const CameraOptics& optics, const Rigid3& world_from_body, double time_s) const;

  std::shared_ptr<const RenderWorld> world_;
  RenderSettings settings_;
  /// Cache by a hash of camera, pose and time. The function is pure, so the cache does not affect results.
  mutable std::map<uint64_t, double> remembered_;
  mutable std::mutex mutex_;
};

}  // namespace lodeline
