#include "simulation/rendering/light/marine_snow.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/rendering/optics/pixel_hash.h"

namespace lodeline {
namespace {

constexpr double kCell_m = 0.4;
constexpr double kFarthest_m = 2.8;  // beyond this distance, a flake is below the noise
constexpr double kNearest_m = 0.06;

struct Flake {
  Vec3 position_W;
  double radius_m;
  double brightness;
};

struct Disc {
  Vec2 centre_px;
  Vec2 streak_px;  ///< movement during the exposure
  double radius_px;
  double energy;  ///< sum of radiance over its pixels
};

Flake flakeOf(uint64_t hash, const Vec3& cell_origin, const SnowOptions& options) {
  const Vec3 inside(uniformFromHash(scrambleBits(hash + 1)), uniformFromHash(scrambleBits(hash + 2)),
                    uniformFromHash(scrambleBits(hash + 3)));
  // Log-normal sizes: many small and few large flakes.
  const double size = std::exp(0.5 * roughNormalFromHash(scrambleBits(hash + 4)));
  return {cell_origin + kCell_m * inside, options.median_radius_m * size,
          0.5 + uniformFromHash(scrambleBits(hash + 5))};
}

/// Lamp light on a flake, W/m^2. Flakes are small and rotate, so there is no cosine.
float irradianceAt(const LightField& light, const Vec3f& point) {
  float sum = light.daylight.inWater(point);
  for (const PlacedLamp& lamp : light.lamps) {
    const Vec3f to_lamp = lamp.position() - point;
    const float distance = std::max(0.05f, to_lamp.norm());
    sum += lamp.irradiance(to_lamp / distance, distance) *
           fastExp(-light.water.mean().diffuse_attenuation * distance);
  }
  return sum;
}

void addDisc(cv::Mat& radiance, const Disc& disc) {
  const double length = disc.streak_px.norm();
  const int copies = std::clamp(static_cast<int>(length / std::max(0.7, disc.radius_px)) + 1, 1, 12);
  const double reach = disc.radius_px + 0.5;
  const double area = std::numbers::pi * (disc.radius_px * disc.radius_px + 1.0 / 12.0);
  const float level = static_cast<float>(disc.energy / (area * copies));
  for (int k = 0; k < copies; ++k) {
    const Vec2 centre = disc.centre_px + ((k + 0.5) / copies - 0.5) * disc.streak_px;
    const int x0 = std::max(0, static_cast<int>(std::ceil(centre.x() - reach)));
    const int y0 = std::max(0, static_cast<int>(std::ceil(centre.y() - reach)));
    const int x1 = std::min(radiance.cols - 1, static_cast<int>(std::floor(centre.x() + reach)));
    const int y1 = std::min(radiance.rows - 1, static_cast<int>(std::floor(centre.y() + reach)));
    for (int y = y0; y <= y1; ++y) {
      float* row = radiance.ptr<float>(y);
      for (int x = x0; x <= x1; ++x) {
        const double distance = std::hypot(x - centre.x(), y - centre.y());
        row[x] += level * static_cast<float>(std::clamp(reach - distance, 0.0, 1.0));
      }
    }
  }
}

}  // namespace

void addMarineSnow(cv::Mat& radiance, const cv::Mat& range_m, const CameraOptics& optics,
                   const Rigid3& world_from_body, const ExposureMotion& motion, const LightField& light,
                   const SnowOptions& options, double time_s, uint64_t seed,
                   const std::vector<Rigid3>& row_poses) {
  if (options.flakes_per_m3 <= 0.0) return;
  const Rigid3 world_from_projector = world_from_body * optics.bodyFromProjector();
  const Rigid3 projector_from_world = world_from_projector.inverse();
  const Vec3 eye = world_from_projector.translation;
  const Vec3 forward = world_from_projector.rotation * Vec3::UnitZ();
  const Vec3 drift = options.current ? options.current->at(time_s)
                                     : Vec3(options.drift_speed_m_per_s * time_s * Vec3(0.7, 0.6, -0.25));
  // Movement of the water during the exposure, camera axes.
  Vec3 carried_C = Vec3::Zero();
  if (options.current) {
    carried_C =
        world_from_projector.rotation.conjugate() * (options.current->at(time_s + 0.5 * motion.exposure_s) -
                                                     options.current->at(time_s - 0.5 * motion.exposure_s));
  }
  const double focal_px = 1.0 / optics.pixelAngle();
  const double mean_per_cell = options.flakes_per_m3 * kCell_m * kCell_m * kCell_m;

  const auto addFlake = [&](const Flake& flake) {
    Vec3 point_C = projector_from_world * flake.position_W;
    const double range = point_C.norm();
    if (point_C.z() < kNearest_m || range > kFarthest_m) return;
    auto pixel = optics.projector().project(point_C);
    if (pixel && !row_poses.empty()) {
      const long row = std::clamp(std::lround(pixel->y()), 0L, static_cast<long>(row_poses.size()) - 1);
      point_C = (row_poses[row] * optics.bodyFromProjector()).inverse() * flake.position_W;
      pixel = optics.projector().project(point_C);
    }
    if (!pixel || !optics.projector().contains(*pixel, -20.0)) return;
    const int x = std::clamp(static_cast<int>(std::lround(pixel->x())), 0, radiance.cols - 1);
    const int y = std::clamp(static_cast<int>(std::lround(pixel->y())), 0, radiance.rows - 1);
    if (range_m.at<float>(y, x) < range) return;

    const double scale = focal_px / point_C.z();
    const double radius_px = flake.radius_m * scale;
    // Circle of confusion of a thin lens, as a radius in pixels.
    const double blur_px =
        0.5 * focal_px * options.aperture_m * std::abs(1.0 / point_C.z() - 1.0 / options.focus_m);
    const float arriving = irradianceAt(light, flake.position_W.cast<float>());
    const float back = fastExp(-light.water.mean().attenuation * static_cast<float>(range));
    const double brightness = flake.brightness * options.reflectance / std::numbers::pi * arriving * back;
    const Vec3 before = motion.start_from_middle * (point_C - 0.5 * carried_C);
    const Vec3 after = motion.end_from_middle * (point_C + 0.5 * carried_C);
    const Vec2 streak = focal_px * (after.head<2>() / after.z() - before.head<2>() / before.z());
    addDisc(radiance, {*pixel, streak, std::max(0.6, std::hypot(radius_px, blur_px)),
                       brightness * std::numbers::pi * radius_px * radius_px});
  };

  const Vec3 still_eye = eye - drift;
  const Eigen::Vector3i low = ((still_eye.array() - kFarthest_m) / kCell_m).floor().cast<int>();
  const Eigen::Vector3i high = ((still_eye.array() + kFarthest_m) / kCell_m).floor().cast<int>();
  for (int i = low.x(); i <= high.x(); ++i)
    for (int j = low.y(); j <= high.y(); ++j)
      for (int k = low.z(); k <= high.z(); ++k) {
        const Vec3 origin = kCell_m * Vec3(i, j, k) + drift;
        const Vec3 to_centre = origin + Vec3::Constant(0.5 * kCell_m) - eye;
        // Half a cell's diagonal is 0.35 m; views are within 60 degrees of the axis.
        if (to_centre.dot(forward) < 0.5 * to_centre.norm() - 0.35) continue;
        const uint64_t cell =
            combineHash(seed, combineHash(static_cast<uint64_t>(i),
                                          combineHash(static_cast<uint64_t>(j), static_cast<uint64_t>(k))));
        const int count = static_cast<int>(mean_per_cell + uniformFromHash(scrambleBits(cell)));
        for (int n = 0; n < count; ++n) addFlake(flakeOf(combineHash(cell, n), origin, options));
      }
}

}  // namespace lodeline
