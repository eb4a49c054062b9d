#include "lodeline/mapping/session/loops/loop_closures.h"

#include "lodeline/mapping/graph/motion/level_motion.h"

namespace lodeline {
namespace {

// Standard deviation of an observation that descriptors matched, px: the corner was detected again.
constexpr double kLoopSigma_px = 1.5;

void addObservations(const LinkedFeature& link, Time old_time, Time new_time,
                     const std::vector<std::shared_ptr<const Camera>>& cameras, LoopClosures* closures) {
  for (const BodyRay& ray : link.new_rays) {
    const auto in_camera = cameras[static_cast<size_t>(ray.camera)]->viewRay(ray.pixel);
    if (!in_camera) continue;
    LoopObservation seen;
    seen.old_track = link.old_track;
    seen.old_time = old_time;
    seen.new_time = new_time;
    seen.observation.track = link.new_track;
    seen.observation.camera = ray.camera;
    seen.observation.pixel = ray.pixel;
    seen.observation.bearing_C = in_camera->direction_C;
    seen.observation.origin_C = in_camera->fromNearestPoint().origin_C;
    seen.observation.sigma_px = kLoopSigma_px;
    closures->observations.push_back(seen);
    if (link.new_track >= 0) return;  // the tracks are joined; their other observations come along
  }
}

}  // namespace

LoopClosures loopClosures(const std::vector<VerifiedLoop>& accepted, const KnownKeyframes& known, int dive,
                          const std::vector<std::shared_ptr<const Camera>>& cameras) {
  LoopClosures closures;
  for (const VerifiedLoop& verified : accepted) {
    const KnownKeyframe& old_keyframe = known.at(verified.loop.old_keyframe);
    const KnownKeyframe& new_keyframe = known.at(verified.loop.new_keyframe);
    if (old_keyframe.dive != dive) continue;
    for (const LinkedFeature& link : verified.links)
      addObservations(link, old_keyframe.time, new_keyframe.time, cameras, &closures);
  }
  if (closures.observations.empty()) return closures;
  Rigid3 odom_from_map;
  for (const KnownKeyframe& keyframe : known.all()) {
    if (keyframe.dive != dive) continue;
    if (closures.initial_poses.empty())
      odom_from_map = mapFromOdom(keyframe.odom_from_body, keyframe.map_from_body);
    closures.initial_poses.push_back({keyframe.time, odom_from_map * keyframe.map_from_body});
  }
  return closures;
}

}  // namespace lodeline
