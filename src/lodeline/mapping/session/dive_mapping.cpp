#include "lodeline/mapping/session/dive_mapping.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/recognition/merge_keyframes.h"
#include "lodeline/mapping/session/loops/cloud_loops.h"
#include "lodeline/mapping/session/loops/field_support.h"
#include "lodeline/mapping/session/map_north.h"
#include "lodeline/mapping/session/map_surface.h"
#include "lodeline/util/thread_clock.h"

namespace lodeline {
namespace {

// Keyframes after which the file is brought up to date. A killed program loses no more than these.
constexpr int kKeyframesPerCommit = 25;
// Length of a clip with which a place is looked for without a prediction.
constexpr double kClip_s = 3.0;

DivePlacement placementOf(const DiveStart& start, const MapKeyframe& first, double north_sigma_rad) {
  DivePlacement placement;
  placement.is_known = first.heading_sigma_rad.has_value() && north_sigma_rad < 1.0;
  placement.azimuth_sigma_rad = std::hypot(first.heading_sigma_rad.value_or(M_PI), north_sigma_rad);
  placement.position_sigma_m =
      Vec3(start.horizontal_sigma_m, start.horizontal_sigma_m, start.vertical_sigma_m);
  placement.map_from_odom.rotation = so3::exp(first.north_from_odom_rad * Vec3::UnitZ());
  placement.map_from_odom.translation =
      start.position - placement.map_from_odom.rotation * first.odom_from_body.translation;
  return placement;
}

RelativePose poseOf(const Loop& loop) { return {loop.old_from_new, loop.covariance}; }

std::vector<LinkedFeature> linksOf(const Loop& loop, const MapKeyframe& old_keyframe,
                                   const MapKeyframe& new_keyframe) {
  std::vector<LinkedFeature> links;
  for (const FeatureMatch& match : loop.inlier_matches) {
    const MapFeature& old_feature = old_keyframe.features[static_cast<size_t>(match.old_feature)];
    const MapFeature& new_feature = new_keyframe.features[static_cast<size_t>(match.new_feature)];
    if (old_feature.track >= 0) links.push_back({old_feature.track, new_feature.track, new_feature.rays});
  }
  return links;
}

}  // namespace

DiveMapping::DiveMapping(MapFile* own, MapDive dive, const MapFile* earlier, const MappingOptions& options)
    : own_(own),
      dive_(std::move(dive)),
      earlier_(earlier),
      options_(options),
      verifier_(options.verifier),
      search_(options.candidates),
      graph_(options.graph),
      tags_(options.tags) {
  change_.emplace(own_->change());
  dive_.id = change_->addDive(dive_);
  if (earlier_ != nullptr) {
    loadEarlier();
    options_.factors.north_sigma_rad = northSigma_rad(northOf(*earlier_), dive_.heading_reference);
  }
  is_placed_ = earlier_ == nullptr;
  DivePlacement placement;
  placement.is_known = is_placed_;
  known_.startDive(dive_number_, placement);
  tags_.startDive(dive_number_);
}

void DiveMapping::place(const MapKeyframe& first) {
  const DivePlacement placement = placementOf(*options_.start, first, options_.factors.north_sigma_rad);
  known_.placement(dive_number_) = placement;
  map_from_odom_ = placement.map_from_odom;
  is_placed_ = placement.is_known;
}

void DiveMapping::loadEarlier() {
  for (const MapDive& dive : earlier_->dives()) {
    dive_number_ = std::max(dive_number_, dive.id + 1);
    std::map<KeyframeId, RelativePose> edge_to;
    earlier_->forEachEdge(dive.id, [&](const OdometryEdge& edge) {
      edge_to[edge.new_keyframe] = {edge.old_from_new, edge.covariance};
    });
    known_.startDive(dive.id, DivePlacement{});
    double path_m = 0.0;
    std::vector<KeyframeId> ids;
    earlier_->forEachKeyframe(dive.id, [&](const StoredKeyframe& row) { ids.push_back(row.keyframe.id); });
    for (const KeyframeId id : ids) {
      const StoredKeyframe row = *earlier_->keyframe(id);
      MapKeyframe keyframe = row.keyframe;
      keyframe.features = earlier_->features(id);
      const auto edge = edge_to.find(id);
      const RelativePose* odometry = edge == edge_to.end() ? nullptr : &edge->second;
      if (odometry) path_m += odometry->from_from_to.translation.norm();
      const Rigid3 pose = row.solved ? row.solved->map_from_body : keyframe.odom_from_body;
      known_.add(knownOf(keyframe, pose, path_m), odometry);
      if (!keyframe.features.empty()) index_.add(keyframe);
      next_id_ = std::max(next_id_, id + 1);
    }
  }
  if (std::optional<SurfaceHeight> surface = surfaceOf(*earlier_)) {
    surface->sigma_m = std::hypot(surface->sigma_m, options_.factors.common_depth_sigma_m);
    graph_.add(*surface);
  }
  tags_.load(*earlier_);
}

MapKeyframe DiveMapping::full(KeyframeId id) const {
  const bool is_own = known_.at(id).dive == dive_number_;
  return is_own ? own_->fullKeyframe(id) : earlier_->fullKeyframe(id);
}

void DiveMapping::store(MapKeyframe* keyframe) {
  keyframe->id = next_id_++;
  keyframe->dive = dive_.id;
  change_->addKeyframe(*keyframe);
  std::optional<RelativePose> odometry;
  if (previous_) {
    previous_->dive = dive_.id;
    odometry = odometryEdge(*previous_, *keyframe, 0.0, options_.factors.odometry);
    change_->addEdge({previous_->id, keyframe->id, odometry->from_from_to, odometry->covariance});
    previous_->dive = dive_number_;
  }
  if (++uncommitted_ >= kKeyframesPerCommit) {
    change_->commit();
    change_.reset();
    change_.emplace(own_->change());
    uncommitted_ = 0;
  }
  keyframe->dive = dive_number_;
  if (!previous_ && earlier_ != nullptr && options_.start) place(*keyframe);
  MapKeyframe measured = *keyframe;
  measured.features.clear();
  addKeyframe(measured, previous_ ? &*previous_ : nullptr, &graph_, map_from_odom_, options_.factors);
  const double moved_m = odometry ? odometry->from_from_to.translation.norm() : 0.0;
  path_m_ += moved_m;
  known_.add(knownOf(*keyframe, map_from_odom_ * keyframe->odom_from_body, path_m_),
             odometry ? &*odometry : nullptr);
  previous_ = std::move(measured);
  ++summary_.keyframes;
}

void DiveMapping::look(const MapKeyframe& keyframe, MappingStep* step) {
  decidePending(false, step);
  for (const LoopCandidateKeyframe& candidate : search_.find(keyframe, known_, index_)) {
    const MapKeyframe old_keyframe = full(candidate.id);
    Loop loop = verifier_.verify(old_keyframe, keyframe, candidate.prediction);
    // Without a prediction, a clip may tell what a single image does not.
    const bool by_clip = !candidate.prediction && loop.status == LoopStatus::Matched && recent_.size() > 1;
    if (by_clip) loop = verifier_.verify(old_keyframe, mergeKeyframes({recent_.begin(), recent_.end()}));
    loop.old_keyframe = candidate.id;
    loop.new_keyframe = keyframe.id;
    loop.source = candidate.source();
    ++summary_.candidates;
    if (!isVerified(&loop)) continue;
    VerifiedLoop verified{loop, {}};
    if (!by_clip) verified.links = linksOf(loop, old_keyframe, keyframe);
    verified.loop.inlier_matches.clear();
    const bool has_prediction = candidate.prediction && !candidate.is_wide;
    pending_.push_back(
        {std::move(verified), {has_prediction, !has_prediction && isFieldTelling(known_, loop)}});
    decidePending(false, step);
  }
  use(acceptance_.expire(keyframe.id, known_), step);
}

void DiveMapping::decidePending(bool is_end, MappingStep* step) {
  std::vector<PendingLoop> pending;
  std::swap(pending, pending_);
  for (PendingLoop& waiting : pending) {
    Loop& loop = waiting.verified.loop;
    const double since_m = path_m_ - known_.at(loop.new_keyframe).path_m;
    if (!is_end && waiting.evidence.needs_field && since_m < FieldSupportOptions{}.reach_m) {
      pending_.push_back(std::move(waiting));
      continue;
    }
    if (loop.new_keyframe != previous_->id) judgeByField(known_, &loop);
    if (loop.status == LoopStatus::Refused) {
      ++summary_.refused;
      record(loop);
    } else {
      use(acceptance_.add(std::move(waiting.verified), waiting.evidence, known_), step);
    }
  }
}

bool DiveMapping::isVerified(Loop* loop) {
  if (loop->status == LoopStatus::Verified) {
    ++summary_.verified;
    judgeByField(known_, loop);
    if (loop->status == LoopStatus::Verified) return true;
    ++summary_.refused;
  }
  record(*loop);
  return false;
}

void DiveMapping::record(const Loop& loop) {
  ledger_.push_back(loop);
  ledger_.back().inlier_matches.clear();
}

DiveTags::Join DiveMapping::joining() {
  return [this](KeyframeId id) {
    joinGraph(id);
    return graph_.contains(id);
  };
}

void DiveMapping::recordRefused(const GraphSummary& solution) {
  auto next = ledger_.begin();
  for (const FactorReport& factor : solution.factors) {
    if (factor.kind != FactorReport::Kind::Loop) continue;
    next = std::find_if(next, ledger_.end(), [&](const Loop& loop) {
      return loop.status == LoopStatus::Accepted && !isTagTie(loop) && loop.old_keyframe == factor.from &&
             loop.new_keyframe == factor.to;
    });
    if (next == ledger_.end()) return;
    if (!factor.accepted) {
      next->status = LoopStatus::Refused;
      next->reason = factor.reason;
      --summary_.accepted;
      ++summary_.refused;
    }
    ++next;
  }
}

void DiveMapping::joinGraph(KeyframeId earlier) {
  if (graph_.contains(earlier)) return;
  const StoredKeyframe row = *earlier_->keyframe(earlier);
  if (!row.solved) return;
  const Rigid3& pose = row.solved->map_from_body;
  const int dive = row.keyframe.dive;
  graph_.addNode(earlier, dive, pose);
  constexpr double kLeast_m = 1e-3, kLeast_rad = 1e-4;
  const Mat6& covariance = row.solved->covariance;
  PositionMeasurement position;
  position.name = "keyframe " + std::to_string(earlier);
  position.node = earlier;
  position.position_W = pose.translation;
  position.covariance = covariance.topLeftCorner<3, 3>() + kLeast_m * kLeast_m * Mat3::Identity();
  position.robust = false;
  graph_.add(position);
  const auto sigma = [&](int axis) { return std::sqrt(std::max(0.0, covariance(axis, axis))) + kLeast_rad; };
  graph_.add(
      TiltMeasurement{earlier, pose.rotation.conjugate() * Vec3::UnitZ(), std::max(sigma(3), sigma(4))});
  graph_.add(AzimuthPrior{dive, 0.0, kLeast_rad});
  graph_.add(HeadingMeasurement{earlier, pose.rotation, sigma(5)});
}

void DiveMapping::use(std::vector<VerifiedLoop> decided, MappingStep* step) {
  for (VerifiedLoop& verified : decided) {
    const Loop& loop = verified.loop;
    record(loop);
    if (loop.status != LoopStatus::Accepted) {
      ++summary_.refused;
      continue;
    }
    const bool between_dives = known_.at(loop.old_keyframe).dive != dive_number_;
    if (between_dives) joinGraph(loop.old_keyframe);
    graph_.add(edgeOf(loop));
    known_.addLoop(loop.old_keyframe, loop.new_keyframe, poseOf(loop));
    ++summary_.accepted;
    if (between_dives) {
      ++summary_.accepted_between_dives;
      is_placed_ = true;
      known_.placement(dive_number_).is_known = true;
    }
    step->accepted.push_back(std::move(verified));
  }
}

void DiveMapping::use(const TagStep& tags) {
  summary_.candidates += static_cast<int>(tags.ties.size() + tags.refused.size());
  summary_.refused += static_cast<int>(tags.refused.size());
  for (const Loop& refused : tags.refused) record(refused);
  for (const TagTie& tie : tags.ties) {
    if (known_.at(tie.row.old_keyframe).dive != dive_number_) {
      is_placed_ = true;
      known_.placement(dive_number_).is_known = true;
    }
    new_ties_.push_back(tie);
  }
}

GraphSummary DiveMapping::solve() {
  const GraphSummary solution = graph_.solve();
  has_north_ = has_north_ || graph_.azimuthSigma(dive_number_).has_value();
  updatePoses();
  if (new_ties_.empty()) return solution;
  const GraphCovariance covariances = graph_.covariance();
  for (auto& [tie, place] : new_ties_) {
    const auto observation = std::find_if(solution.factors.begin(), solution.factors.end(),
                                          [name = place, id = tie.new_keyframe](const FactorReport& factor) {
                                            return factor.kind == FactorReport::Kind::LandmarkObservation &&
                                                   factor.from == id && factor.name == name;
                                          });
    const bool is_used = observation != solution.factors.end() && observation->accepted;
    const RelativePose relative = covariances.relative(tie.old_keyframe, tie.new_keyframe);
    tie.old_from_new = relative.from_from_to;
    tie.covariance = relative.covariance;
    if (!is_used) {
      tie.status = LoopStatus::Refused;
      tie.reason = observation == solution.factors.end() ? "not in the graph" : observation->reason;
      ++summary_.refused;
    } else {
      known_.addLoop(tie.old_keyframe, tie.new_keyframe, relative);
      ++summary_.verified;
      ++summary_.accepted;
      if (known_.at(tie.old_keyframe).dive != dive_number_) ++summary_.accepted_between_dives;
    }
    record(tie);
  }
  new_ties_.clear();
  return solution;
}

void DiveMapping::updatePoses() {
  for (KnownKeyframe& keyframe : known_.all()) {
    if (keyframe.dive == dive_number_) keyframe.map_from_body = graph_.pose(keyframe.id);
  }
  const KnownKeyframe& newest = known_.at(previous_->id);
  map_from_odom_ = mapFromOdom(newest.map_from_body, newest.odom_from_body);
}

MappingStep DiveMapping::add(MapKeyframe keyframe) {
  const double start_s = threadSeconds();
  store(&keyframe);
  recent_.push_back(keyframe);
  const Time oldest = keyframe.time - Duration::fromSeconds(kClip_s);
  std::erase_if(recent_, [&](const MapKeyframe& other) { return other.time < oldest; });
  MappingStep step;
  step.keyframe = keyframe.id;
  use(tags_.add(keyframe, known_, &graph_, joining()));
  look(keyframe, &step);
  index_.add(keyframe);
  if (!step.accepted.empty() || !new_ties_.empty()) solve();
  step.has_north = has_north_;
  step.is_placed = is_placed_;
  step.map_from_odom = map_from_odom_;
  summary_.processor_s += threadSeconds() - start_s;
  return step;
}

void DiveMapping::registerClouds() {
  std::vector<MapKeyframe> keyframes;
  own_->forEachKeyframe(dive_.id, [&](const StoredKeyframe& row) { keyframes.push_back(row.keyframe); });
  Vec3 view_B = Vec3::Zero();
  for (const KnownKeyframe& keyframe : known_.all()) {
    if (keyframe.dive == dive_number_) view_B += keyframe.view_B;
  }
  const auto features = [this](KeyframeId id) { return own_->features(id); };
  LoopAcceptance acceptance;
  MappingStep step;
  for (Loop& loop : cloudLoops(keyframes, features, view_B.normalized())) {
    ++summary_.candidates;
    if (!isVerified(&loop)) continue;
    use(acceptance.add({loop, {}}, {.has_prediction = true}, known_), &step);
  }
  use(acceptance.expire(previous_->id, known_, true), &step);
}

MappingSummary DiveMapping::finish(Time end) {
  const double start_s = threadSeconds();
  MappingStep last;
  if (previous_) {
    decidePending(true, &last);
    use(acceptance_.expire(previous_->id, known_, true), &last);
    registerClouds();
    use(tags_.finish(known_, &graph_, joining()));
    recordRefused(solve());
    const GraphCovariance covariances = graph_.covariance();
    for (const KnownKeyframe& keyframe : known_.all()) {
      if (keyframe.dive == dive_number_)
        change_->setSolution(keyframe.id, {keyframe.map_from_body, covariances.of(keyframe.id)});
    }
  }
  for (const Loop& loop : ledger_) {
    // Loops with another map's keyframes go to the common map.
    if (known_.at(loop.old_keyframe).dive == dive_number_ && !isTagTie(loop)) change_->addLoop(loop);
  }
  tags_.write(known_, &*change_);
  dive_.end = end;
  change_->updateDive(dive_);
  change_->commit();
  change_.reset();
  summary_.is_placed = is_placed_;
  summary_.processor_s += threadSeconds() - start_s;
  return summary_;
}

}  // namespace lodeline
