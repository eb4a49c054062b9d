#include "simulation/rendering/light/light_meter.h"

#include <bit>
#include <cmath>

#include "simulation/rendering/light/haze_volume.h"
#include "simulation/rendering/light/place_light.h"
#include "simulation/rendering/light/surface_shader.h"
#include "simulation/rendering/optics/pixel_hash.h"

namespace lodeline {
namespace {

constexpr int kColumns = 20, kRows = 16;  // 20 packets of rays
constexpr int kMeasurements = 6;          // number of past measurements used
constexpr size_t kMostRemembered = 4096;

uint64_t hashOf(const Rigid3& pose, double time_s) {
  uint64_t hash = std::bit_cast<uint64_t>(time_s);
  for (int axis = 0; axis < 3; ++axis) {
    hash = combineHash(hash, std::bit_cast<uint64_t>(pose.translation[axis]));
  }
  for (const double q : pose.rotation.coeffs()) hash = combineHash(hash, std::bit_cast<uint64_t>(q));
  return hash;
}

}  // namespace

std::vector<float> LightMeter::measure(const CameraOptics& optics, const Rigid3& world_from_body,
                                       double time_s) const {
  const Rigid3 world_from_camera = world_from_body * optics.bodyFromCamera();
  const Mat3f rotation = world_from_camera.rotation.toRotationMatrix().cast<float>();
  const Vec3f position = world_from_camera.translation.cast<float>();
  const LightField light = placeLight(settings_, optics, world_from_body, time_s);
  const SurfaceShader shader(world_->scene, world_->texture, world_->texture_origin_W);
  std::vector<int> pixels;
  std::vector<Vec3f> directions;
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      const int x = (2 * i + 1) * optics.width() / (2 * kColumns);
      const int y = (2 * j + 1) * optics.height() / (2 * kRows);
      pixels.push_back(y * optics.width() + x);
      directions.push_back(rotation * optics.direction(pixels.back()));
    }
  }
  // A node of haze for every ray.
  const HazeVolume haze(light, position, directions, kColumns);
  std::vector<float> measured;
  measured.reserve(pixels.size());
  for (size_t first = 0; first < pixels.size(); first += kRayPacketSize) {
    RayPacket rays;
    for (int lane = 0; lane < kRayPacketSize; ++lane) {
      const int pixel = pixels[first + lane];
      if (optics.sees(pixel)) {
        rays.set(lane, position + rotation * optics.origin(pixel), directions[first + lane], kSight_m);
      } else {
        rays.disable(lane);
      }
    }
    HitPacket hits;
    world_->scene.intersect(rays, hits);
    intersectBodies(light.bodies, rays, hits);
    float radiance[kRayPacketSize];
    shader.shade(rays, hits, light, optics.pixelAngle(), false, radiance);
    for (int lane = 0; lane < kRayPacketSize; ++lane) {
      const int n = static_cast<int>(first) + lane;
      const HazeSample veil =
          haze.at(static_cast<float>(n % kColumns * HazeVolume::kNodeSpacing_px),
                  static_cast<float>(n / kColumns * HazeVolume::kNodeSpacing_px), hits.range_m[lane]);
      measured.push_back(optics.light(pixels[n]) * (radiance[lane] * veil.transmittance + veil.radiance));
    }
  }
  return measured;
}

double LightMeter::wantedExposure(const CameraOptics& optics, const Rigid3& world_from_body,
                                  double time_s) const {
  const uint64_t key = hashOf(world_from_body * optics.bodyFromCamera(), time_s);
  {
    const std::lock_guard lock(mutex_);
    const auto found = remembered_.find(key);
    if (found != remembered_.end()) return found->second;
  }
  const double wanted_s = meteredExposure(settings_.sensor, measure(optics, world_from_body, time_s));
  const std::lock_guard lock(mutex_);
  if (remembered_.size() >= kMostRemembered) remembered_.clear();
  remembered_[key] = wanted_s;
  return wanted_s;
}

ExposureSetting LightMeter::exposure(const CameraOptics& optics, const WorldFromBodyAt& motion,
                                     double time_s) const {
  const double lag_s = settings_.sensor.exposure_lag_s;
  const double step_s = 0.5 * lag_s;
  double sum = 0.0, weights = 0.0;
  for (int k = 0; k < kMeasurements; ++k) {
    const double when_s = (std::floor(time_s / step_s) - k) * step_s;
    const double weight = std::exp(-(time_s - when_s) / lag_s);
    sum += weight * std::log(wantedExposure(optics, motion(when_s), when_s));
    weights += weight;
  }
  return splitExposure(settings_.sensor, std::exp(sum / weights));
}

}  // namespace lodeline
