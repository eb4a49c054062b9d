#include "lodeline/mapping/session/keyframe_choice.h"

#include "lodeline/diagnostics.h"

namespace lodeline {

void KeyframeChoiceOptions::check() const {
  if (!(distance_m > 0.0)) throw UsageError("expert.loops.keyframe_distance_m must be positive");
  if (!(turn_rad > 0.0)) throw UsageError("expert.loops.keyframe_turn_rad must be positive");
  if (!(least_interval_s >= 0.0)) throw UsageError("the least interval of keyframes must not be negative");
}

KeyframeChoice::KeyframeChoice(const KeyframeChoiceOptions& options) : options_(options) { options_.check(); }

bool KeyframeChoice::add(const FrameEstimate& estimate) {
  const bool sees = estimate.status == Status::Tracking || estimate.status == Status::Degraded;
  if (!sees) return false;
  const NavigationState& now = estimate.state;
  if (last_) {
    if ((now.time - last_->time).seconds() < options_.least_interval_s) return false;
    const Rigid3 last_from_now = last_->world_from_body.inverse() * now.world_from_body;
    const double turn_rad = Quat::Identity().angularDistance(last_from_now.rotation);
    if (last_from_now.translation.norm() < options_.distance_m && turn_rad < options_.turn_rad) return false;
  }
  last_ = now;
  return true;
}

}  // namespace lodeline
