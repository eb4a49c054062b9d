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
    const double interval_s = (now.time - last_->time).seconds();
    if (interval_s < options_.least_interval_s) return false;
    const bool is_late = interval_s >= options_.usual_interval_s;
    const Rigid3 last_from_now = last_->world_from_body.inverse() * now.world_from_body;
    const double turn_rad = Quat::Identity().angularDistance(last_from_now.rotation);
    const double needed_m = is_late ? options_.least_distance_m : options_.distance_m;
    const double needed_rad = is_late ? options_.least_turn_rad : options_.turn_rad;
    if (last_from_now.translation.norm() < needed_m && turn_rad < needed_rad) return false;
  }
  last_ = now;
  return true;
}

}  // namespace lodeline
