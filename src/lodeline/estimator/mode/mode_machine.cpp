#include "lodeline/estimator/mode/mode_machine.h"

#include <algorithm>
#include <array>

namespace lodeline {
namespace {

constexpr std::array<ModeTransition, 12> kTransitions = {{
    {Mode::Waiting, ModeEvent::Started, Mode::StartingUp},
    {Mode::StartingUp, ModeEvent::ScaleKnown, Mode::Tracking},
    {Mode::StartingUp, ModeEvent::StartupTooLong, Mode::Tracking},
    {Mode::StartingUp, ModeEvent::VisionLost, Mode::InertialOnly},
    {Mode::Tracking, ModeEvent::VisionLost, Mode::InertialOnly},
    {Mode::Recovering, ModeEvent::VisionLost, Mode::InertialOnly},
    {Mode::Recovering, ModeEvent::ScaleKnown, Mode::Tracking},
    {Mode::Recovering, ModeEvent::StartupTooLong, Mode::Tracking},
    {Mode::InertialOnly, ModeEvent::VisionBack, std::nullopt},
    {Mode::InertialOnly, ModeEvent::VisionBackScaleLost, Mode::Recovering},
    // The window of a rig in the dark goes on to fill, and to slide.
    {Mode::InertialOnly, ModeEvent::ScaleKnown, Mode::InertialOnly},
    {Mode::InertialOnly, ModeEvent::StartupTooLong, Mode::InertialOnly},
}};

}  // namespace

std::span<const ModeTransition> modeTransitions() { return kTransitions; }

const char* toString(Mode mode) {
  switch (mode) {
    case Mode::Waiting:
      return "waiting";
    case Mode::StartingUp:
      return "starting up";
    case Mode::Tracking:
      return "tracking";
    case Mode::InertialOnly:
      return "inertial only";
    case Mode::Recovering:
      return "recovering";
  }
  return "";
}

const char* toString(ModeEvent event) {
  switch (event) {
    case ModeEvent::Started:
      return "started";
    case ModeEvent::ScaleKnown:
      return "scale known";
    case ModeEvent::StartupTooLong:
      return "start-up too long";
    case ModeEvent::VisionLost:
      return "vision lost";
    case ModeEvent::VisionBack:
      return "vision back";
    case ModeEvent::VisionBackScaleLost:
      return "vision back, scale lost";
  }
  return "";
}

void ModeMachine::apply(ModeEvent event) {
  const auto next = [event](Mode from, Mode before_darkness) {
    const auto line = std::find_if(kTransitions.begin(), kTransitions.end(), [&](const ModeTransition& t) {
      return t.from == from && t.event == event;
    });
    return line == kTransitions.end() ? from : line->to.value_or(before_darkness);
  };
  const bool is_of_vision = event == ModeEvent::VisionLost || event == ModeEvent::VisionBack;
  mode_ = next(mode_, phase_);
  if (event == ModeEvent::VisionBackScaleLost) {
    phase_ = mode_;
  } else if (!is_of_vision) {
    phase_ = next(phase_, phase_);
  }
}

void ModeMachine::start(bool scale_is_given, int frames) {
  scale_is_given_ = scale_is_given;
  frames_since_start_ = frames;
  apply(ModeEvent::Started);
}

bool ModeMachine::see(Time now, bool sees, bool has_velocity) {
  if (!sees) {
    if (!blind_since_ || has_velocity) unaided_since_ = now;
    if (!blind_since_) blind_since_ = now;
    apply(ModeEvent::VisionLost);
    return false;
  }
  const bool was_dark = blind_since_ && (now - *blind_since_).seconds() > kDarkness_s;
  const bool was_unaided = was_dark && (now - unaided_since_).seconds() > kDarkness_s;
  blind_since_.reset();
  if (!was_unaided || scale_is_given_) {
    apply(ModeEvent::VisionBack);
    return was_dark;
  }
  apply(ModeEvent::VisionBackScaleLost);
  settled_at_.reset();
  scale_was_lost_ = true;
  frames_since_start_ = 0;
  return true;
}

void ModeMachine::judgeScale(Time now, double sigma) {
  const bool was_marginalizing = isMarginalizing(), was_settled = isSettled();
  if (!was_settled && isScaleKnown(sigma)) settled_at_ = now;
  frames_since_settled_ = was_settled ? frames_since_settled_ + 1 : 0;
  if (isSettled() && !lossesAdapt()) apply(ModeEvent::ScaleKnown);
  if (!isSettled() && frames_since_start_ >= options_.startup_max_frames) apply(ModeEvent::StartupTooLong);
  has_changed_ = isMarginalizing() && (!was_marginalizing || !was_settled);
}

bool ModeMachine::isScaleKnown(double sigma) const {
  const int least = scale_is_given_ ? options_.startup_frames : options_.startup_frames_mono;
  if (frames_since_start_ < least) return false;
  return scale_is_given_ || sigma < options_.startup_scale_sigma;
}

bool ModeMachine::lossesAdapt() const {
  constexpr int kFramesToAdapt = 3;
  return !scale_is_given_ && frames_since_settled_ < kFramesToAdapt;
}

bool ModeMachine::isWorthKeeping(Time now) const {
  constexpr double kToFindIntrinsics_s = 5.0;
  return settled_at_ && (!scale_is_given_ || (now - *settled_at_).seconds() >= kToFindIntrinsics_s);
}

}  // namespace lodeline
