#include "lodeline/batch/loops/initial_correction.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

Quat aboutVertical(double turn_rad) { return so3::exp(turn_rad * Vec3::UnitZ()); }

/// Turn about the vertical that brings a rotation closest to the identity's heading.
double verticalTurnOf(const Quat& rotation) { return 2.0 * std::atan2(rotation.z(), rotation.w()); }

double nearestTurn(double turn_rad, double to_rad) {
  return to_rad + std::remainder(turn_rad - to_rad, 2.0 * std::numbers::pi);
}

}  // namespace

InitialCorrection::InitialCorrection(const std::vector<FrameEstimate>& frames,
                                     const std::vector<InitialPose>& poses) {
  for (const InitialPose& pose : poses) {
    const Rigid3& wanted = pose.world_from_body;
    if (!wanted.translation.allFinite() || !wanted.rotation.coeffs().allFinite())
      throw InputError("An initial pose of the batch solution is not finite.");
    if (!knots_.empty() && pose.time <= knots_.back().time)
      throw InputError("The initial poses of the batch solution are not in order of time.");
    const auto frame =
        std::lower_bound(frames.begin(), frames.end(), pose.time,
                         [](const FrameEstimate& estimate, Time time) { return estimate.time < time; });
    if (frame == frames.end() || frame->time != pose.time)
      throw InputError("An initial pose of the batch solution has a time without a frame.");
    const Rigid3& estimated = frame->state.world_from_body;
    const double turn_rad = verticalTurnOf(wanted.rotation * estimated.rotation.conjugate());
    Knot knot;
    knot.time = pose.time;
    knot.turn_rad = nearestTurn(turn_rad, knots_.empty() ? 0.0 : knots_.back().turn_rad);
    knot.shift_W = wanted.translation - aboutVertical(knot.turn_rad) * estimated.translation;
    knots_.push_back(knot);
  }
}

Vec3 InitialCorrection::Knot::moved(const Vec3& position_W) const {
  return aboutVertical(turn_rad) * position_W + shift_W;
}

NavigationState InitialCorrection::apply(NavigationState state) const {
  if (knots_.empty()) return state;
  const auto after = std::upper_bound(knots_.begin(), knots_.end(), state.time,
                                      [](Time time, const Knot& knot) { return time < knot.time; });
  const Knot& end = after == knots_.end() ? knots_.back() : *after;
  const Knot& begin = after == knots_.begin() ? end : *std::prev(after);
  const double span_s = (end.time - begin.time).seconds();
  const double share = span_s > 0.0 ? (state.time - begin.time).seconds() / span_s : 0.0;
  const Quat turn = aboutVertical(begin.turn_rad + share * (end.turn_rad - begin.turn_rad));
  const Vec3& position_W = state.world_from_body.translation;
  state.world_from_body = Rigid3(turn * state.world_from_body.rotation,
                                 (1.0 - share) * begin.moved(position_W) + share * end.moved(position_W));
  state.velocity_W = turn * state.velocity_W;
  return state;
}

}  // namespace lodeline
