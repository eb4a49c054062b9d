#include "lodeline/problem/marginalization/landmark_host.h"

namespace lodeline {

std::optional<MapPoint> mapPointOf(const Window& window, TrackId id, const FeatureTrack& track,
                                   const FactorBuilder& factors) {
  constexpr double kMinInverseDistance = 1e-3;
  const Landmark& landmark = *track.landmark;
  if (landmark.inverseDistance() < kMinInverseDistance) return std::nullopt;
  const Vec3 point_C = landmark.base.direction(landmark.parameters.data()) / landmark.inverseDistance();
  const Rigid3 world_from_camera = factors.worldFromCamera(window, *window.find(landmark.host), 0);
  return MapPoint{id, world_from_camera * point_C, static_cast<int>(track.observations.size())};
}

void moveToNewHost(const Window& window, FeatureTrack& track, FrameId excluded,
                   const FactorBuilder& factors) {
  Landmark& landmark = *track.landmark;
  const Rigid3 world_from_old = factors.worldFromCamera(window, *window.find(landmark.host), 0);
  for (auto observation = track.observations.rbegin(); observation != track.observations.rend();
       ++observation) {
    const Frame* frame = window.find(observation->frame);
    if (observation->camera != 0 || !frame->is_keyframe || frame->id == excluded) continue;
    const Rigid3 new_from_old = factors.worldFromCamera(window, *frame, 0).inverse() * world_from_old;
    // Homogeneous, so that points at infinity can be converted too.
    const Vec3 point_new = new_from_old.rotation * landmark.base.direction(landmark.parameters.data()) +
                           landmark.inverseDistance() * new_from_old.translation;
    const LandmarkBase base(observation->measurement.bearing_C);
    const double depth = base.bearing_C.dot(point_new);
    if (depth < 0.1 * point_new.norm()) break;
    const Vec2 ab = base.tangent_C.transpose() * point_new / depth;
    landmark.host = frame->id;
    landmark.base = base;
    landmark.parameters = {ab.x(), ab.y(), landmark.inverseDistance() / depth};
    return;
  }
  track.landmark.reset();
}

std::optional<FeatureTrack> splitTrack(const Window& window, FeatureTrack& track, FrameId last,
                                       const FactorBuilder& factors) {
  constexpr int kLeastFrames = 4;
  constexpr FrameId kNone = -1;
  FeatureTrack older = track, younger = track;
  std::erase_if(older.observations, [&](const Observation& observation) { return observation.frame > last; });
  std::erase_if(younger.observations,
                [&](const Observation& observation) { return observation.frame <= last; });
  if (older.frameCount() < kLeastFrames || younger.frameCount() < 2) return std::nullopt;
  if (older.landmark->host > last) moveToNewHost(window, older, kNone, factors);
  if (younger.landmark->host <= last) moveToNewHost(window, younger, kNone, factors);
  if (!older.landmark || !younger.landmark) return std::nullopt;
  track = std::move(younger);
  return older;
}

}  // namespace lodeline
