#include "lodeline/mapping/session/loops/known_keyframes.h"

namespace lodeline {
namespace {

// A prediction considers this many of the latest loops. Later loops are nearer to the present keyframe.
constexpr size_t kMostLoops = 8;

double extent(const RelativePose& pose) { return pose.covariance.topLeftCorner<3, 3>().trace(); }

/// Covariance of [dp, dtheta] of a keyframe by the placement of its dive, in map axes.
Mat6 placementCovariance(const DivePlacement& placement, const KnownKeyframe& keyframe) {
  Mat6 covariance = Mat6::Zero();
  covariance.diagonal().head<3>() = placement.position_sigma_m.cwiseAbs2();
  Eigen::Matrix<double, 6, 1> by_turn;
  by_turn << Vec3::UnitZ().cross(keyframe.map_from_body.translation - placement.map_from_odom.translation),
      Vec3::UnitZ();
  covariance += placement.azimuth_sigma_rad * placement.azimuth_sigma_rad * by_turn * by_turn.transpose();
  return covariance;
}

/// Mean viewing direction of a keyframe's features, unit.
Vec3 viewOf(const MapKeyframe& keyframe) {
  Vec3 sum = Vec3::Zero();
  for (const MapFeature& feature : keyframe.features) {
    if (!feature.rays.empty()) sum += feature.rays.front().bearing_B;
  }
  return sum.norm() > 1e-9 ? Vec3(sum.normalized()) : Vec3::UnitX();
}

}  // namespace

KnownKeyframe knownOf(const MapKeyframe& keyframe, const Rigid3& map_from_body, double path_m) {
  KnownKeyframe known;
  known.id = keyframe.id;
  known.dive = keyframe.dive;
  known.time = keyframe.time;
  known.odom_from_body = keyframe.odom_from_body;
  known.map_from_body = map_from_body;
  known.view_B = viewOf(keyframe);
  known.path_m = path_m;
  known.depth_m = keyframe.depth_m;
  known.field = keyframe.field;
  return known;
}

void KnownKeyframes::startDive(int dive, const DivePlacement& placement) {
  placements_[dive] = placement;
  chains_.try_emplace(dive);
}

void KnownKeyframes::add(const KnownKeyframe& keyframe, const RelativePose* newest_from_this) {
  OdometryChain& chain = chains_.at(keyframe.dive);
  if (newest_from_this == nullptr) {
    chain.start(keyframe.id, keyframe.odom_from_body);
  } else {
    chain.extend(keyframe.id, *newest_from_this);
  }
  first_.try_emplace(keyframe.dive, keyframes_.size());
  index_[keyframe.id] = keyframes_.size();
  keyframes_.push_back(keyframe);
}

void KnownKeyframes::addLoop(KeyframeId old_keyframe, KeyframeId new_keyframe,
                             const RelativePose& old_from_new) {
  loops_.push_back({old_keyframe, new_keyframe, old_from_new});
}

RelativePose KnownKeyframes::byPlacement(const KnownKeyframe& from, const KnownKeyframe& to) const {
  RelativePose relative;
  relative.from_from_to = from.map_from_body.inverse() * to.map_from_body;
  Mat6 covariance = Mat6::Zero();
  for (const KnownKeyframe* keyframe : {&from, &to}) {
    covariance += placementCovariance(placements_.at(keyframe->dive), *keyframe);
    const OdometryChain& chain = chains_.at(keyframe->dive);
    const KnownKeyframe& first = keyframes_[first_.at(keyframe->dive)];
    Mat6 drift = chain.relative(first.id, keyframe->id).covariance;
    const Mat3 map_from_first = first.map_from_body.rotation.toRotationMatrix();
    Mat6 turn = Mat6::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = map_from_first;
    covariance += turn * drift * turn.transpose();
  }
  Mat6 turn = Mat6::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() =
      from.map_from_body.rotation.conjugate().toRotationMatrix();
  relative.covariance = turn * covariance * turn.transpose();
  return relative;
}

RelativePose KnownKeyframes::between(KeyframeId from, KeyframeId to) const {
  const KnownKeyframe& a = at(from);
  const KnownKeyframe& b = at(to);
  return a.dive == b.dive ? chains_.at(a.dive).relative(from, to) : byPlacement(a, b);
}

std::optional<LoopPrediction> KnownKeyframes::predict(KeyframeId from, KeyframeId to) const {
  const KnownKeyframe& a = at(from);
  const KnownKeyframe& b = at(to);
  std::optional<RelativePose> best;
  const bool are_placed = placements_.at(a.dive).is_known && placements_.at(b.dive).is_known;
  if (a.dive == b.dive || are_placed) best = between(from, to);
  size_t considered = 0;
  for (auto loop = loops_.rbegin(); loop != loops_.rend() && considered < kMostLoops; ++loop) {
    const KnownKeyframe& old_end = at(loop->old_keyframe);
    const KnownKeyframe& new_end = at(loop->new_keyframe);
    if (old_end.dive != a.dive || new_end.dive != b.dive) continue;
    ++considered;
    const RelativePose by_loop =
        composed(composed(between(from, old_end.id), loop->old_from_new), between(new_end.id, to));
    if (!best || extent(by_loop) < extent(*best)) best = by_loop;
  }
  if (!best) return std::nullopt;
  return LoopPrediction{best->from_from_to, best->covariance};
}

}  // namespace lodeline
