#include "lodeline/mapping/cloud/trials/test_tube.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lodeline/geometry/so3.h"

namespace lodeline::test {
namespace {

constexpr double kCentreStep_m = 0.1;
constexpr double kMargin_m = 12.0;

double wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

}  // namespace

TubeWorld::TubeWorld(const Tube& tube) : tube_(tube) {
  std::mt19937_64 random(tube.seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const double from = -kMargin_m, to = tube.length_m + kMargin_m;
  const double phases[2] = {6.28 * unit(random), 6.28 * unit(random)};
  Vec3 centre(0.0, 0.0, 0.0);
  for (double s = from; s <= to; s += kCentreStep_m) {
    const double heading =
        tube.bend_rad * (0.6 * std::sin(s / 4.3 + phases[0]) + 0.4 * std::sin(s / 9.1 + phases[1]));
    const double climb = tube.bend_rad * 0.2 * std::sin(s / 6.0 + phases[1]);
    headings_.push_back(heading);
    centres_.push_back(centre);
    centre += kCentreStep_m * Vec3(std::cos(heading), std::sin(heading), climb);
  }
  const int number = static_cast<int>(tube.bumps_per_m * (tube.is_extruded ? 4.0 : to - from));
  for (int i = 0; i < number; ++i) {
    Bump bump;
    bump.along_m = from + (to - from) * unit(random);
    bump.around_rad = wrapped(6.2832 * unit(random));
    bump.height_m = tube.bump_m * (2.0 * unit(random) - 1.0);
    bump.width_along_m = tube.is_extruded ? 1e6 : 0.25 + 0.6 * unit(random);
    bump.width_around_rad = 0.2 + 0.5 * unit(random);
    bumps_.push_back(bump);
  }
  std::sort(bumps_.begin(), bumps_.end(), [](const Bump& a, const Bump& b) { return a.along_m < b.along_m; });
}

Vec3 TubeWorld::centre(double along_m) const {
  const double place =
      std::clamp((along_m + kMargin_m) / kCentreStep_m, 0.0, static_cast<double>(centres_.size()) - 1.001);
  const auto i = static_cast<size_t>(place);
  const double share = place - static_cast<double>(i);
  return (1.0 - share) * centres_[i] + share * centres_[i + 1];
}

double TubeWorld::heading(double along_m) const {
  const double place =
      std::clamp((along_m + kMargin_m) / kCentreStep_m, 0.0, static_cast<double>(headings_.size()) - 1.001);
  const auto i = static_cast<size_t>(place);
  const double share = place - static_cast<double>(i);
  return (1.0 - share) * headings_[i] + share * headings_[i + 1];
}

Rigid3 TubeWorld::body(double along_m, bool looks_back) const {
  const double azimuth = heading(along_m) + (looks_back ? std::numbers::pi : 0.0);
  Mat3 axes;
  axes.col(2) = Vec3(std::cos(azimuth), std::sin(azimuth), 0.0);
  axes.col(1) = -Vec3::UnitZ();
  axes.col(0) = axes.col(1).cross(axes.col(2));
  return Rigid3(Quat(axes).normalized(), centre(along_m));
}

double TubeWorld::radiusAt(double along_m, double around_rad) const {
  double radius = tube_.radius_m;
  const double reach = tube_.is_extruded ? 1e9 : 2.5;
  auto first = std::lower_bound(bumps_.begin(), bumps_.end(), along_m - reach,
                                [](const Bump& bump, double place) { return bump.along_m < place; });
  for (; first != bumps_.end() && first->along_m < along_m + reach; ++first) {
    const double a = (along_m - first->along_m) / first->width_along_m;
    const double b = wrapped(around_rad - first->around_rad) / first->width_around_rad;
    // Rounded steps: steeper than bells, as ledges are.
    radius += first->height_m * std::exp(-0.5 * (a * a + b * b) * (0.5 + 0.25 * (a * a + b * b)));
  }
  return std::max(radius, 0.4);
}

double TubeWorld::outside(const Vec3& place, double& along_m) const {
  for (int i = 0; i < 2; ++i) {
    const double azimuth = heading(along_m);
    along_m += (place - centre(along_m)).dot(Vec3(std::cos(azimuth), std::sin(azimuth), 0.0));
  }
  const double azimuth = heading(along_m);
  const Vec3 arm = place - centre(along_m);
  const double left = arm.dot(Vec3(-std::sin(azimuth), std::cos(azimuth), 0.0));
  if (tube_.has_two_walls) return std::abs(left) - tube_.radius_m;
  return std::hypot(left, arm.z()) - radiusAt(along_m, std::atan2(arm.z(), left));
}

double TubeWorld::rangeAlong(const Vec3& origin, const Vec3& direction, double along_m) const {
  double before = 0.0;
  double place = along_m;
  for (double range = 0.1; range <= 8.0; range += 0.1) {
    if (outside(origin + range * direction, place) < 0.0) {
      before = range;
      continue;
    }
    double after = range;
    for (int i = 0; i < 8; ++i) {
      const double middle = 0.5 * (before + after);
      (outside(origin + middle * direction, place) < 0.0 ? before : after) = middle;
    }
    return 0.5 * (before + after);
  }
  return -1.0;
}

std::vector<MapKeyframe> swim(const TubeWorld& world, double from_m, double to_m, const TubeNoise& noise,
                              std::mt19937_64& random,
                              const std::function<Rigid3(const Rigid3&, double)>& moved) {
  constexpr double kStep_m = 0.5;
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const bool looks_back = to_m < from_m;
  const int number = static_cast<int>(std::abs(to_m - from_m) / kStep_m) + 1;
  std::vector<MapKeyframe> keyframes;
  for (int i = 0; i < number; ++i) {
    const double path = kStep_m * i;
    const double along = looks_back ? from_m - path : from_m + path;
    Rigid3 pose = world.body(along, looks_back);
    pose.translation += Vec3(0.0, 0.0, 0.05 * std::sin(path));
    MapKeyframe keyframe;
    keyframe.id = i;
    keyframe.odom_from_body = moved ? moved(pose, path) : pose;
    const int points = static_cast<int>(noise.points_per_m * kStep_m + unit(random));
    for (int tries = 0; tries < 400 && static_cast<int>(keyframe.features.size()) < points; ++tries) {
      // A field of view of 90 by 70 degrees.
      const Vec3 ray_B = Vec3(2.0 * unit(random) - 1.0, 1.4 * unit(random) - 0.7, 1.0).normalized();
      double range = world.rangeAlong(pose.translation, pose.rotation * ray_B, along);
      if (range < 0.3 || range > 6.0) continue;
      const double sigma = noise.sigma_per_m * range * range;
      const double chance = unit(random);
      if (chance < noise.outlier_share)
        range *= 0.5 + unit(random);
      else if (chance < noise.outlier_share + noise.particle_share)
        range *= 0.2 + 0.7 * unit(random);
      MapFeature feature;
      BodyRay ray;
      ray.bearing_B = ray_B;
      feature.rays.push_back(ray);
      feature.distance_sigma_m = sigma + 0.002;
      const Vec3 across = tangentBasis(ray_B) * Vec2(normal(random), normal(random)) * 1e-3 * range;
      feature.point_B = noise.scale * ((range + feature.distance_sigma_m * normal(random)) * ray_B + across);
      keyframe.features.push_back(feature);
    }
    keyframes.push_back(std::move(keyframe));
  }
  return keyframes;
}

}  // namespace lodeline::test
