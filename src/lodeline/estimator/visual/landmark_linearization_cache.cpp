#include "lodeline/estimator/visual/landmark_linearization_cache.h"

#include <algorithm>

#include "lodeline/estimator/visual/reprojection_system.h"

namespace lodeline {
namespace {

/// The newest keyframe without motion. Frames interpolated after it depend on a recent keyframe.
const Frame* newestOldKeyframe(const Window& window) {
  const Frame* newest = nullptr;
  for (const auto& frame : window.frames()) {
    if (!frame->has_motion && !frame->interpolated) newest = frame.get();
  }
  return newest;
}

}  // namespace

void LandmarkLinearizationCache::freeze(Window& window, const FactorBuilder& factors) {
  const Frame* newest_old = newestOldKeyframe(window);
  if (!tracks_.empty() || most_frames_ == 0 || !newest_old) return;
  for (auto& [id, track] : window.tracks()) {
    track.is_frozen = track.landmark && track.observations.back().frame <= newest_old->id;
    if (track.is_frozen) tracks_.emplace_back(id, track.observations.size());
  }
  if (tracks_.empty()) return;

  ReprojectionSystem terms(window, factors, ReprojectionSystem::Of::kFrozen);
  NormalEquations system;
  terms.addTo(&system);
  cost_ = terms.cost();
  const std::vector<double> sigmas = terms.errors();
  auto next = sigmas.begin();
  for (const auto& [id, observations] : tracks_) {
    const FeatureTrack& track = window.tracks().at(id);
    for (const Observation& observation : track.observations) {
      if (!track.isHosted(observation)) errors_.push_back({id, observation.frame, *next});
      ++next;
    }
  }
  keep(system, window);
  for (const auto& frame : window.frames()) {
    if (!frame->has_motion) old_frames_.push_back({frame->id, frame->first_pose});
  }
  parameter_blocks_ = window.globals().size();
}

void LandmarkLinearizationCache::keep(const NormalEquations& system, const Window& window) {
  std::vector<int> rows;
  for (const NormalEquations::Block& block : system.blocks()) {
    // The cached terms do not depend on the poses of recent frames, which may be removed sooner.
    const auto is_recent = [&](const auto& frame) {
      return frame->has_motion && frame->pose.data() == block.value;
    };
    if (std::any_of(window.frames().begin(), window.frames().end(), is_recent)) continue;
    blocks_.push_back({block.value, block.ambient_size, static_cast<int>(rows.size())});
    for (int i = 0; i < block.tangentSize(); ++i) rows.push_back(block.offset + i);
  }
  hessian_ = system.hessian()(rows, rows);
  gradient_ = system.gradient()(rows);
  const Frame& reference = *newestOldKeyframe(window);
  reference_ = reference.pose.data();
  first_reference_ = reference.firstWorldFromBody();
  for (Eigen::VectorXd& value : values())
    then_.blocks.push_back({blocks_[then_.blocks.size()].value, std::move(value)});
}

void LandmarkLinearizationCache::invalidateIfStale(Window& window) {
  if (tracks_.empty()) return;
  if (frames_ < most_frames_ && hold(window) && !haveMoved()) {
    ++frames_;
    return;
  }
  for (auto& [id, track] : window.tracks()) track.is_frozen = false;
  *this = LandmarkLinearizationCache(most_frames_);
}

bool LandmarkLinearizationCache::hold(const Window& window) const {
  const auto is_as_it_was = [&](const FrameThen& then) {
    const Frame* frame = window.find(then.id);
    return frame && frame->first_pose == then.first_pose;
  };
  const auto is_unchanged = [&](const auto& track) {
    const auto found = window.tracks().find(track.first);
    return found != window.tracks().end() && found->second.landmark &&
           found->second.observations.size() == track.second;
  };
  return window.globals().size() == parameter_blocks_ &&
         std::all_of(old_frames_.begin(), old_frames_.end(), is_as_it_was) &&
         std::all_of(tracks_.begin(), tracks_.end(), is_unchanged);
}

bool LandmarkLinearizationCache::haveMoved() const {
  constexpr double kFar_m = 0.03, kFar_rad = 0.005;
  const Eigen::VectorXd moved = step();
  for (const NormalEquations::Block& block : blocks_) {
    if (block.ambient_size != kPoseSize) continue;
    if (moved.segment<3>(block.offset).norm() > kFar_m ||
        moved.segment<3>(block.offset + 3).norm() > kFar_rad)
      return true;
  }
  return false;
}

std::vector<Eigen::VectorXd> LandmarkLinearizationCache::values() const {
  const Rigid3 first_from_now = first_reference_ * poseFromBlock(reference_).inverse();
  std::vector<Eigen::VectorXd> values;
  for (const NormalEquations::Block& block : blocks_) {
    values.emplace_back(Eigen::Map<const Eigen::VectorXd>(block.value, block.ambient_size));
    if (block.ambient_size == kPoseSize)
      poseToBlock(first_from_now * poseFromBlock(block.value), values.back().data());
  }
  return values;
}

Eigen::VectorXd LandmarkLinearizationCache::step() const {
  const std::vector<Eigen::VectorXd> now = values();
  std::vector<const double*> pointers;
  for (const Eigen::VectorXd& value : now) pointers.push_back(value.data());
  return then_.difference(pointers.data());
}

double LandmarkLinearizationCache::cost() const {
  if (blocks_.empty()) return 0.0;
  const Eigen::VectorXd d = step();
  return cost_ + d.dot(gradient_ + 0.5 * (hessian_ * d));
}

void LandmarkLinearizationCache::addTo(NormalEquations* system) const {
  if (!blocks_.empty()) system->add(blocks_, hessian_, gradient_ + hessian_ * step());
}

}  // namespace lodeline
