#include "lodeline/mapping/cloud/local_cloud.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/squared.h"

namespace lodeline {
namespace {

/// Covariance of a point at the end of a ray: `along` the ray and `across` it, m.
Mat3 rayCovariance(const Vec3& view, double along, double across) {
  const Vec3 direction = view.normalized();
  return squared(across) * Mat3::Identity() +
         (squared(along) - squared(across)) * direction * direction.transpose();
}

/// First and last index of the keyframes within `half_m` along the path of the middle one.
std::pair<size_t, size_t> stretchAround(const std::vector<MapKeyframe>& keyframes, size_t middle,
                                        double half_m) {
  const auto step = [&](size_t i) {
    return (keyframes[i + 1].odom_from_body.translation - keyframes[i].odom_from_body.translation).norm();
  };
  size_t first = middle, last = middle;
  for (double path = 0.0; first > 0 && (path += step(first - 1)) <= half_m; --first) {
  }
  for (double path = 0.0; last + 1 < keyframes.size() && (path += step(last)) <= half_m; ++last) {
  }
  return {first, last};
}

/// A feature as a point of the cloud; false where its position is unknown or too uncertain.
bool pointOf(const MapFeature& feature, const Rigid3& frame_from_body, const LocalCloudOptions& options,
             CloudPoint& point) {
  if (!feature.point_B || feature.rays.empty()) return false;
  if (!(feature.distance_sigma_m > 0.0) || feature.distance_sigma_m > options.max_sigma_m) return false;
  if (!feature.point_B->allFinite()) throw InputError("a landmark of a keyframe has no finite position");
  point.position_F = frame_from_body * *feature.point_B;
  point.view_F = frame_from_body.rotation * (*feature.point_B - feature.rays.front().origin_B);
  const double distance_m = point.view_F.norm();
  if (distance_m < 1e-3) return false;
  point.covariance_F =
      rayCovariance(point.view_F, feature.distance_sigma_m, feature.rays.front().sigma_rad * distance_m);
  point.track = feature.track;
  return point.position_F.norm() <= options.radius_m;
}

}  // namespace

void LocalCloudOptions::check() const {
  for (const auto& [value, name] : {std::pair(radius_m, "radius_m"),
                                    {path_half_m, "path_half_m"},
                                    {max_sigma_m, "max_sigma_m"},
                                    {voxel_m, "voxel_m"},
                                    {landmark_sigma_per_m, "landmark_sigma_per_m"}}) {
    if (!(value > 0.0) || !std::isfinite(value))
      throw UsageError(fmt::format("{} of a local cloud is {}; it must be positive", name, value));
  }
  if (neighbours < 6 || neighbours > 32)
    throw UsageError(fmt::format("neighbours of a local cloud is {}; 6 to 32 are possible", neighbours));
}

LocalCloud cloudOfKeyframes(const std::vector<MapKeyframe>& keyframes, size_t middle,
                            const LocalCloudOptions& options) {
  options.check();
  if (middle >= keyframes.size())
    throw UsageError(
        fmt::format("keyframe {} of {} cannot be the middle of a cloud", middle, keyframes.size()));
  LocalCloud cloud;
  cloud.keyframe = keyframes[middle].id;
  cloud.odom_from_frame = keyframes[middle].odom_from_body;
  cloud.up_F = cloud.odom_from_frame.rotation.conjugate() * Vec3::UnitZ();
  std::map<TrackId, size_t> place_of_track;
  const auto [first, last] = stretchAround(keyframes, middle, options.path_half_m);
  for (size_t i = first; i <= last; ++i) {
    if (!keyframes[i].odom_from_body.matrix().allFinite())
      throw InputError(fmt::format("keyframe {} has no finite pose", keyframes[i].id));
    const Rigid3 frame_from_body = cloud.odom_from_frame.inverse() * keyframes[i].odom_from_body;
    for (const MapFeature& feature : keyframes[i].features) {
      CloudPoint point;
      if (!pointOf(feature, frame_from_body, options, point)) continue;
      const auto known = point.track < 0 ? place_of_track.end() : place_of_track.find(point.track);
      if (known == place_of_track.end()) {
        if (point.track >= 0) place_of_track[point.track] = cloud.points.size();
        cloud.points.push_back(point);
        continue;
      }
      CloudPoint& other = cloud.points[known->second];
      point.observations = other.observations + 1;
      if (point.covariance_F.trace() < other.covariance_F.trace()) other = point;
      other.observations = point.observations;
    }
  }
  finishCloud(cloud, options);
  return cloud;
}

LocalCloud cloudOfLandmarks(const std::vector<SeenLandmark>& landmarks, KeyframeId keyframe,
                            const Rigid3& world_from_frame, const LocalCloudOptions& options) {
  options.check();
  constexpr int kLeastObservations = 3;
  LocalCloud cloud;
  cloud.keyframe = keyframe;
  cloud.odom_from_frame = world_from_frame;
  cloud.up_F = world_from_frame.rotation.conjugate() * Vec3::UnitZ();
  const Rigid3 frame_from_world = world_from_frame.inverse();
  for (const SeenLandmark& seen : landmarks) {
    if (seen.landmark.observations < kLeastObservations) continue;
    CloudPoint point;
    point.position_F = frame_from_world * seen.landmark.position;
    point.view_F = frame_from_world.rotation * (seen.landmark.position - seen.seen_from);
    const double distance_m = point.view_F.norm();
    const double along_m = options.landmark_sigma_per_m * squared(distance_m);
    if (!std::isfinite(distance_m)) throw InputError("a landmark of a run has no finite position");
    if (point.position_F.norm() > options.radius_m || along_m > options.max_sigma_m || distance_m < 1e-3)
      continue;
    point.covariance_F = rayCovariance(point.view_F, along_m, 1e-3 * distance_m);
    point.observations = seen.landmark.observations;
    cloud.points.push_back(point);
  }
  finishCloud(cloud, options);
  return cloud;
}

}  // namespace lodeline
