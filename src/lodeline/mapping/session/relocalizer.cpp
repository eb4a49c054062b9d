#include "lodeline/mapping/session/relocalizer.h"

#include <algorithm>
#include <set>

#include "lodeline/mapping/graph/motion/relative_pose.h"
#include "lodeline/mapping/graph/robust/robust_weights.h"
#include "lodeline/mapping/recognition/merge_keyframes.h"

namespace lodeline {
namespace {

constexpr int kMostCandidates = 8;
constexpr size_t kMostOfClip = 3;  // keyframes of a clip that are examined singly
constexpr size_t kNeeded = 2;      // keyframes of the map that agree
// Probability with which two true places count as agreeing: 3 sigma.
constexpr double kAgreement = 0.9973;

Mat6 turned(const Quat& rotation, const Mat6& covariance) {
  Mat6 turn = Mat6::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = rotation.toRotationMatrix();
  return turn * covariance * turn.transpose();
}

}  // namespace

Relocalizer::Relocalizer(const MapFile& map, const LoopVerifierOptions& options)
    : map_(map), verifier_(options) {
  for (const MapDive& dive : map.dives()) {
    std::vector<KeyframeId> ids;
    map.forEachKeyframe(dive.id, [&](const StoredKeyframe& row) {
      if (row.feature_count > 0 && row.solved) ids.push_back(row.keyframe.id);
    });
    for (const KeyframeId id : ids) index_.add(map.fullKeyframe(id));
  }
}

std::vector<Relocalizer::Found> Relocalizer::examine(const MapKeyframe& keyframe,
                                                     const Rigid3& seen_from_last,
                                                     std::string* reason) const {
  std::vector<Found> places;
  for (const SimilarKeyframe& similar : index_.query(keyframe, kMostCandidates)) {
    Loop loop = verifier_.verify(map_.fullKeyframe(similar.id), keyframe);
    loop.old_keyframe = similar.id;
    loop.new_keyframe = keyframe.id;
    loop.source = "appearance";
    if (loop.status != LoopStatus::Verified) {
      *reason = loop.reason;
      continue;
    }
    const Rigid3 map_from_old = map_.keyframe(similar.id)->solved->map_from_body;
    places.push_back({map_from_old * loop.old_from_new * seen_from_last,
                      turned(map_from_old.rotation, loop.covariance), loop});
  }
  return places;
}

std::optional<PlaceInMap> Relocalizer::find(std::span<const MapKeyframe> clip, std::string* reason) const {
  *reason = "no keyframe of the map looks alike";
  // The whole clip, and the newest keyframes each by itself.
  std::vector<Found> places = examine(mergeKeyframes(clip), Rigid3(), reason);
  const size_t first = clip.size() - std::min(clip.size(), kMostOfClip);
  for (size_t k = first; k < clip.size() && clip.size() > 1; ++k) {
    const Rigid3 this_from_last = clip[k].odom_from_body.inverse() * clip.back().odom_from_body;
    const std::vector<Found> found = examine(clip[k], this_from_last, reason);
    places.insert(places.end(), found.begin(), found.end());
  }
  const double limit = chiSquaredQuantile(kAgreement, 6);
  // The place with which most others agree; neighbouring keyframes of the map are as accurate as odometry.
  Mat6 of_map = Mat6::Zero();
  constexpr double kMap_m = 0.01, kMap_rad = 0.003;
  of_map.diagonal() << Vec3::Constant(kMap_m * kMap_m), Vec3::Constant(kMap_rad * kMap_rad);
  std::vector<size_t> best;
  for (const Found& centre : places) {
    std::vector<size_t> agreeing;
    for (size_t i = 0; i < places.size(); ++i) {
      const Mat6 covariance = centre.covariance + places[i].covariance + of_map;
      if (mahalanobisSquared(centre.map_from_body, places[i].map_from_body, covariance) < limit)
        agreeing.push_back(i);
    }
    if (agreeing.size() > best.size()) best = agreeing;
  }
  std::set<KeyframeId> agreeing_ids;
  for (const size_t i : best) agreeing_ids.insert(places[i].loop.old_keyframe);
  if (agreeing_ids.size() < kNeeded) {
    if (!places.empty()) *reason = "only one keyframe of the map agrees with the clip";
    return std::nullopt;
  }
  const size_t surest = *std::min_element(best.begin(), best.end(), [&](size_t a, size_t b) {
    return places[a].covariance.trace() < places[b].covariance.trace();
  });
  PlaceInMap place{places[surest].map_from_body, places[surest].covariance, {}};
  for (const size_t i : best) place.loops.push_back(places[i].loop);
  reason->clear();
  return place;
}

}  // namespace lodeline
