#include "lodeline/mapping/recognition/merge_keyframes.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

/// Bits in which two views of one point differ as little as to be one descriptor.
constexpr int kSameLook = 30;

/// Error of the odometry from one keyframe to another, one sigma per axis. As its errors accumulate, the
/// difference of both covariances is that of the motion between them.
struct Drift {
  double position_m = 0.0, rotation_rad = 0.0;

  Drift(const MapKeyframe& from, const MapKeyframe& to) {
    constexpr double kLeast_m = 0.001, kLeast_rad = 0.0003, kPerMetre = 0.003;
    const Mat6 difference = to.covariance - from.covariance;
    const double path_m = (to.odom_from_body.translation - from.odom_from_body.translation).norm();
    const auto sigma = [](const auto& block) { return std::sqrt(std::abs(block.trace()) / 3.0); };
    position_m = std::hypot(sigma(difference.topLeftCorner<3, 3>()), kLeast_m, kPerMetre * path_m);
    rotation_rad = std::hypot(sigma(difference.bottomRightCorner<3, 3>()), kLeast_rad);
  }
};

MapFeature carriedOver(MapFeature feature, const Rigid3& last_from_this, const Drift& drift) {
  constexpr double kUsualDistance_m = 2.0;
  const double distance_m =
      feature.point_B ? (*feature.point_B - feature.rays.front().origin_B).norm() : kUsualDistance_m;
  for (BodyRay& ray : feature.rays) {
    ray.origin_B = last_from_this * ray.origin_B;
    ray.bearing_B = last_from_this.rotation * ray.bearing_B;
    ray.sigma_rad = std::hypot(ray.sigma_rad, drift.rotation_rad, drift.position_m / distance_m);
  }
  if (feature.point_B) feature.point_B = last_from_this * *feature.point_B;
  feature.distance_sigma_m = std::hypot(feature.distance_sigma_m, drift.position_m);
  return feature;
}

/// Whether a feature shows the same as one of an earlier keyframe: the same track, or an untracked corner in
/// about the same direction, with almost the same descriptor.
bool isSame(const MapFeature& a, const MapFeature& b) {
  constexpr double kAboutTheSame = 0.97;  // cosine of 14 degrees, for the parallax of a corner
  if (a.track != b.track || distanceOf(a.descriptor, b.descriptor) > kSameLook) return false;
  return a.track >= 0 || a.rays.front().bearing_B.dot(b.rays.front().bearing_B) > kAboutTheSame;
}

void checkClip(std::span<const MapKeyframe> clip) {
  if (clip.empty()) throw UsageError("a clip to be merged needs at least one keyframe");
  for (size_t i = 1; i < clip.size(); ++i) {
    if (clip[i].dive != clip[0].dive) throw UsageError("keyframes to be merged belong to different dives");
    if (!(clip[i - 1].time < clip[i].time))
      throw UsageError("keyframes to be merged are not in order of time");
  }
}

}  // namespace

MapKeyframe mergeKeyframes(std::span<const MapKeyframe> clip, size_t reference) {
  checkClip(clip);
  if (reference >= clip.size())
    throw UsageError("the reference of keyframes to be merged is not one of them");
  const MapKeyframe& centre = clip[reference];
  MapKeyframe merged = centre;
  const auto add = [&](const MapKeyframe& keyframe) {
    const Rigid3 centre_from_this = centre.odom_from_body.inverse() * keyframe.odom_from_body;
    const Drift drift(keyframe, centre);
    const size_t before = merged.features.size();
    for (const MapFeature& feature : keyframe.features) {
      MapFeature carried = carriedOver(feature, centre_from_this, drift);
      const auto end = merged.features.begin() + static_cast<ptrdiff_t>(before);
      if (std::none_of(merged.features.begin(), end,
                       [&](const MapFeature& other) { return isSame(other, carried); })) {
        merged.features.push_back(std::move(carried));
      }
    }
  };
  // The view of a point that is nearest in time comes first: its pose is the most accurate.
  for (size_t apart = 1; apart < clip.size(); ++apart) {
    if (apart <= reference) add(clip[reference - apart]);
    if (reference + apart < clip.size()) add(clip[reference + apart]);
  }
  return merged;
}

MapKeyframe mergeKeyframes(std::span<const MapKeyframe> clip) {
  return mergeKeyframes(clip, clip.empty() ? 0 : clip.size() - 1);
}

}  // namespace lodeline
