#pragma once

#include <optional>
#include <span>

#include "lodeline/estimate.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/types.h"

namespace lodeline {

enum class ModeEvent {
  Started,             ///< a window was initialized
  ScaleKnown,          ///< the scale is known well enough, and the robust losses have adapted
  StartupTooLong,      ///< the window has no room for more frames
  VisionLost,          ///< too few landmarks in the newest frame
  VisionBack,          ///< landmarks again, after at most ModeMachine::kDarkness_s, or with the scale kept
  VisionBackScaleLost  ///< the same after longer, with one camera and without a measured velocity
};

const char* toString(ModeEvent event);

/// One line of the transition table. `to` is empty for the mode before the darkness.
struct ModeTransition {
  Mode from;
  ModeEvent event;
  std::optional<Mode> to;
};

/// All transitions. An event without a line for the present mode changes nothing.
std::span<const ModeTransition> modeTransitions();

/// The mode of the estimator, and what it knows of the scale, from frame to frame. Call start() once, then
/// for every frame add(), see() and judgeScale(), in this order.
class ModeMachine {
 public:
  static constexpr double kDarkness_s = 1.0;

  explicit ModeMachine(const WindowOptions& options) : options_(options) {}

  /// Begins with a window of `frames` frames. `scale_is_given`: by a stereo start.
  void start(bool scale_is_given, int frames);
  void addFrame() { ++frames_since_start_; }
  /// `sees`: the newest frame sees enough landmarks. `has_velocity`: a sensor beside cameras and IMU measures
  /// its velocity, which keeps the scale in the dark. Returns true where images are back after more than
  /// kDarkness_s: the linearization points are then those of inertial propagation.
  bool see(Time now, bool sees, bool has_velocity = false);
  /// Judges whether the scale is known; it stays so until vision is lost. `sigma`: relative standard
  /// deviation of the scale, or of the speed where scaleWasLost(); unused where the scale is given.
  void judgeScale(Time now, double sigma);

  Mode mode() const { return mode_; }
  bool scaleIsGiven() const { return scale_is_given_; }
  /// Whether the scale was lost at some time since the start.
  bool scaleWasLost() const { return scale_was_lost_; }
  /// Whether the scale is known: linearization points are kept from then on.
  bool isSettled() const { return settled_at_.has_value(); }
  bool isBlind() const { return blind_since_.has_value(); }
  /// Whether frames are marginalized: not before the first transition to Tracking, nor while recovering.
  bool isMarginalizing() const { return phase_ == Mode::Tracking; }
  /// Whether the newest judgement changed what the marginalization prior may hold: its linearization points
  /// are taken anew.
  bool hasChanged() const { return has_changed_; }
  /// Whether observations of landmarks that outlive the window are kept in the prior. They are not while the
  /// scale is unknown. With a stereo start they are not in its first five seconds either: wrong intrinsics
  /// then show as outliers. The start of one camera determines its speed and biases, which are worth more.
  bool isWorthKeeping(Time now) const;

 private:
  void apply(ModeEvent event);
  bool isScaleKnown(double sigma) const;
  /// A start of one camera is solved with the widest robust losses; their weights are not to be kept.
  bool lossesAdapt() const;

  WindowOptions options_;
  Mode mode_ = Mode::Waiting;
  Mode phase_ = Mode::Waiting;  ///< the mode without regard to darkness
  bool scale_is_given_ = false;
  bool scale_was_lost_ = false;
  bool has_changed_ = false;
  int frames_since_start_ = 0;  ///< or since recovering began
  int frames_since_settled_ = 0;
  std::optional<Time> settled_at_;
  std::optional<Time> blind_since_;
  Time unaided_since_;  ///< while blind: the first blind frame, or the last one with a measured velocity
};

}  // namespace lodeline
