#include "lodeline/mapping/recognition/test_loop_scene.h"

#include <cmath>
#include <numbers>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

constexpr double kBaseline_m = 0.12;

/// A ray with an error in both directions across it.
BodyRay rayTo(const Vec3& point_B, const Vec3& origin_B, int camera, double sigma_rad, SceneMaker* maker) {
  BodyRay ray;
  ray.camera = camera;
  ray.origin_B = origin_B;
  const Vec3 bearing = (point_B - origin_B).normalized();
  const Vec2 error = sigma_rad * Vec2(maker->normal(), maker->normal());
  ray.bearing_B = (bearing + tangentBasis(bearing) * error).normalized();
  ray.sigma_rad = sigma_rad;
  return ray;
}

}  // namespace

double SceneMaker::normal() {
  return std::sqrt(-2.0 * std::log(1.0 - uniform(0.0, 1.0))) *
         std::cos(2.0 * std::numbers::pi * uniform(0.0, 1.0));
}

Descriptor SceneMaker::look() {
  Descriptor descriptor;
  for (uint64_t& bits : descriptor.bits) bits = random_();
  return descriptor;
}

std::vector<ScenePoint> SceneMaker::points(int count) {
  std::vector<ScenePoint> points;
  for (int i = 0; i < count; ++i) {
    const double azimuth = uniform(-0.7, 0.7), elevation = uniform(-0.52, 0.52), distance = uniform(2.0, 6.0);
    points.push_back({distance * Vec3(std::cos(azimuth) * std::cos(elevation),
                                      std::sin(azimuth) * std::cos(elevation), std::sin(elevation)),
                      look()});
  }
  return points;
}

Rigid3 SceneMaker::pose(double reach_m, double turn_rad) {
  const Vec3 turn(uniform(-0.1, 0.1), uniform(-0.1, 0.1), uniform(-turn_rad, turn_rad));
  return {so3::exp(turn),
          reach_m / std::sqrt(3.0) * Vec3(uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0))};
}

MapKeyframe SceneMaker::keyframe(const std::vector<ScenePoint>& points, const Rigid3& world_from_body,
                                 const SceneErrors& errors) {
  MapKeyframe keyframe;
  keyframe.id = next_id_++;
  keyframe.time = Time::fromNanoseconds(keyframe.id * 1'000'000'000);
  const Rigid3 odom_from_world(Quat(Eigen::AngleAxisd(uniform(-3.0, 3.0), Vec3::UnitZ())), normal3(20.0));
  const Rigid3 odom_from_body = odom_from_world * world_from_body;
  const Vec3 tilt(errors.tilt_sigma_rad * normal(), errors.tilt_sigma_rad * normal(), 0.0);
  keyframe.odom_from_body = {so3::exp(tilt) * odom_from_body.rotation, odom_from_body.translation};
  keyframe.covariance.diagonal() << Vec3::Constant(0.01), Vec2::Constant(std::pow(errors.tilt_sigma_rad, 2)),
      1e-4;
  for (const ScenePoint& point : points) {
    const Vec3 point_B = world_from_body.inverse() * point.position_W;
    if (point_B.x() < 0.5) continue;
    MapFeature& feature = keyframe.features.emplace_back();
    feature.descriptor = point.look;
    for (int i = 0; i < errors.flipped_bits; ++i) {
      const size_t bit = below(kDescriptorBits);
      feature.descriptor.bits[bit / 64] ^= uint64_t{1} << (bit % 64);
    }
    feature.rays = {rayTo(point_B, Vec3::Zero(), 0, errors.sigma_rad, this),
                    rayTo(point_B, {0.0, -kBaseline_m, 0.0}, 1, errors.sigma_rad, this)};
    if (uniform(0.0, 1.0) >= errors.share_with_point) continue;
    const double distance_m = point_B.norm();
    // As many images of the rig give it.
    feature.distance_sigma_m = 0.5 * distance_m * distance_m * errors.sigma_rad / kBaseline_m;
    feature.track = static_cast<TrackId>(keyframe.features.size());
    feature.point_B =
        errors.scale * (distance_m + feature.distance_sigma_m * normal()) * feature.rays[0].bearing_B;
  }
  return keyframe;
}

}  // namespace lodeline
