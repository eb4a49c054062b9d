#include "studies/walls/true_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "lodeline/mapping/cloud/cloud_index.h"
#include "simulation/dive/dive_world.h"
#include "simulation/rendering/cave/triangle_mesh.h"

namespace lodeline {

TrueSurface::TrueSurface(const Scenario& scenario)
    : dive_(makeDive(scenario)),
      world_(buildWorld(dive_)),
      renderer_(std::make_unique<ImageRenderer>(world_, dive_.errors.truth.rig, renderSettings(dive_))) {}

std::vector<double> TrueSurface::distances_m(const std::vector<Vec3>& points, size_t most) const {
  const TriangleMesh directions = unitIcosphere(3);
  const size_t step = std::max<size_t>(1, points.size() / most);
  std::vector<double> distances;
  for (size_t i = 0; i < points.size(); i += step) {
    double nearest = 1.0;
    for (const Vec3f& direction : directions.positions) {
      const auto range = world_->scene.range(points[i], direction.cast<double>().normalized());
      if (range) nearest = std::min(nearest, *range);
    }
    distances.push_back(nearest);
  }
  return distances;
}

std::vector<double> TrueSurface::behind_m(const std::vector<Vec3>& points, const Trajectory& true_poses,
                                          size_t most) const {
  std::vector<Vec3> eyes;
  for (const StampedPose& pose : true_poses.poses) eyes.push_back(pose.world_from_body.translation);
  const CloudIndex index(eyes);
  const size_t step = std::max<size_t>(1, points.size() / most);
  std::vector<double> distances;
  std::vector<Neighbour> found;
  for (size_t i = 0; i < points.size(); i += step) {
    index.find(points[i], 1, found);
    const Vec3 sight = points[i] - eyes[found.front().index];
    const auto range = world_->scene.range(eyes[found.front().index], sight.normalized());
    if (range) distances.push_back(sight.norm() - *range);
  }
  return distances;
}

std::optional<SurfaceHit> TrueSurface::hit(const Vec3& eye, const Vec3& direction) const {
  constexpr double kBeside = 4e-4;
  const Vec3 right = direction.unitOrthogonal(), above = direction.cross(right);
  std::array<Vec3, 3> points;
  std::optional<SurfaceHit> hit;
  for (size_t i = 0; i < points.size(); ++i) {
    const Vec3 beside = i == 0 ? Vec3(Vec3::Zero()) : Vec3(kBeside * (i == 1 ? right : above));
    const Vec3 ray = (direction + beside).normalized();
    const auto range_m = world_->scene.range(eye, ray);
    if (!range_m) return std::nullopt;
    if (i == 0) hit = SurfaceHit{*range_m, 0.0};
    points[i] = eye + *range_m * ray;
  }
  const Vec3 normal = (points[1] - points[0]).cross(points[2] - points[0]);
  hit->incidence_rad = std::acos(std::min(1.0, std::abs(normal.normalized().dot(direction))));
  return hit;
}

std::vector<Vec3> TrueSurface::visible(const Trajectory& true_poses, double reach_m) const {
  constexpr double kStep_m = 0.2, kCell_m = 0.04;
  constexpr int kPixelStep = 6;
  const CameraCalibration& camera = dive_.errors.truth.rig.cameras.front();
  std::set<std::array<int, 3>> cells;
  std::vector<Vec3> points;
  std::optional<Vec3> last;
  for (const StampedPose& pose : true_poses.poses) {
    if (last && (pose.world_from_body.translation - *last).norm() < kStep_m) continue;
    last = pose.world_from_body.translation;
    const Vec3 eye = pose.world_from_body * camera.body_from_camera.translation;
    for (int v = 0; v < camera.height_px; v += kPixelStep) {
      for (int u = 0; u < camera.width_px; u += kPixelStep) {
        const auto point = renderer_->hitPoint(0, Vec2(u, v), pose.world_from_body);
        if (!point || (*point - eye).norm() > reach_m) continue;
        const Eigen::Vector3i cell = (*point / kCell_m).array().floor().cast<int>();
        if (cells.insert({cell.x(), cell.y(), cell.z()}).second) points.push_back(*point);
      }
    }
  }
  return points;
}

Trajectory TrueSurface::withoutSilt(const Trajectory& true_poses) const {
  Trajectory clear = true_poses;
  const Time begin = true_poses.poses.front().time;
  const std::vector<SiltEpisode> episodes = renderSettings(dive_).water.silt;
  std::erase_if(clear.poses, [&](const StampedPose& pose) {
    const double time_s = (pose.time - begin).seconds();
    return std::any_of(episodes.begin(), episodes.end(), [&](const SiltEpisode& episode) {
      return time_s >= episode.start_s && time_s < episode.start_s + episode.duration_s;
    });
  });
  return clear;
}

std::vector<double> TrueSurface::sectorAreas_m2(const Rigid3& truth_from_map, const SectionPlane& plane,
                                                size_t sectors) const {
  constexpr size_t kRays = 10;  // in a sector
  std::vector<double> areas(sectors, 0.0);
  const double step_rad = 2.0 * std::numbers::pi / static_cast<double>(kRays * sectors);
  for (size_t i = 0; i < kRays * sectors; ++i) {
    const double angle = step_rad * (static_cast<double>(i) + 0.5);
    const Vec3 direction = std::cos(angle) * plane.right + std::sin(angle) * plane.above;
    const auto range =
        world_->scene.range(truth_from_map * plane.origin, truth_from_map.rotation * direction);
    areas[i / kRays] += 0.5 * step_rad * std::pow(range.value_or(0.0), 2.0);
  }
  return areas;
}

std::vector<double> nearest_m(const std::vector<Vec3>& points, const std::vector<Vec3>& places) {
  const CloudIndex index(points);
  std::vector<double> distances;
  std::vector<Neighbour> found;
  for (const Vec3& place : places) {
    index.find(place, 1, found);
    distances.push_back(found.empty() ? 1e3 : std::sqrt(found.front().squared_distance));
  }
  return distances;
}

}  // namespace lodeline
