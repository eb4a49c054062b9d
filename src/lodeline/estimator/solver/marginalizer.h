#pragma once

#include <utility>
#include <vector>

#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/problem/normal_equations.h"

namespace lodeline {

/// Takes frames and landmarks out of the window without forgetting what they said of those that stay: Schur
/// complement of the terms that touch them, carried on as a Prior (paper section III-B). Blocks that the
/// prior touches for the first time get their linearization point here, and every later Jacobian of theirs is
/// taken there.
class Marginalizer {
 public:
  explicit Marginalizer(const FactorBuilder& factors) : factors_(factors) {}

  /// Starts from a prior on the first frame. It freezes no linearization point: nothing has been eliminated
  /// yet.
  void start(Prior prior) {
    prior_ = std::move(prior);
    prior_.information.resize(0, 0);
  }

  /// Shortens the window to the wanted sizes.
  void marginalizeToSize(Window& window, const WindowOptions& wanted);

  const Prior& prior() const { return prior_; }

  /// Takes the frames' linearization points back: the prior is expressed about their present values, and
  /// every factor is linearized where the frames are until the prior touches them again. Neither translations
  /// nor a turn of everything about gravity become known by it. For frames that may still move by as much as
  /// the baselines between them: a landmark's derivative would be taken along the baseline from one frame's
  /// first estimate to another frame's present value, which then points anywhere.
  void resetLinearizationPoints(Window& window);

  /// Adds what is known of a parameter block from elsewhere: `sigmas` about its present value.
  void addKnowledge(ParameterBlock& state, const Eigen::VectorXd& sigmas) {
    prior_.append(state.value.data(), static_cast<int>(state.value.size()), sigmas);
  }
  /// Takes a parameter block out of the prior without forgetting what it said of the others; no factor of the
  /// window may mention the state any more. A later entry of it starts afresh.
  void forget(Window& window, ParameterBlock& state);

  /// Landmarks that left the window since the last call, in order.
  std::vector<MapPoint> takeMapPoints() { return std::exchange(map_points_, {}); }

 private:
  /// Oldest frame with motion: a keyframe loses its motion. Any other frame goes, for the prior to stay
  /// small. Its observations stay where its pose can be interpolated (keyframe_policy.h); otherwise they are
  /// dropped.
  void marginalizeOldestFrame(Window& window, const WindowOptions& wanted);
  /// Magnetometer and depth terms that touch the oldest of two frames, which then have become part of the
  /// prior.
  void addSensors(const Window& window, Frame& oldest, Frame& next, NormalEquations* system) const;
  /// Oldest keyframe: landmarks that the newest keyframe does not see are marginalized with all their
  /// observations, the others with those before a cut (WindowOptions); where that would leave too few on
  /// either side they lose their observations in the oldest keyframe, and move to another host.
  void removeOldestKeyframe(Window& window, int split_at_keyframe);

  /// New prior from `system`, which holds the old prior and all terms of the eliminated blocks. parameter
  /// blocks walk for `elapsed_s`.
  void eliminate(Window& window, const NormalEquations& system, const std::vector<const double*>& eliminated,
                 double elapsed_s = 0.0);

  const FactorBuilder& factors_;
  Prior prior_;
  std::vector<MapPoint> map_points_;
};

}  // namespace lodeline
