#pragma once

#include <utility>
#include <vector>

#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/normal_equations.h"

namespace lodeline {

/// Removes frames and landmarks from the window and keeps their information about the remaining blocks. The
/// Schur complement of the terms that contain them becomes a Prior (paper section III-B). Blocks that the
/// prior contains for the first time get their linearization point here. All their later Jacobians are taken
/// at that point.
class Marginalizer {
 public:
  explicit Marginalizer(const FactorBuilder& factors) : factors_(factors) {}

  /// Starts from a prior on the first frame. It sets no linearization point, because nothing has been
  /// eliminated yet.
  void start(Prior prior) {
    prior_ = std::move(prior);
    prior_.information.resize(0, 0);
  }

  /// Marginalizes frames until the window has the wanted sizes.
  void marginalizeToSize(Window& window, const WindowOptions& wanted);

  const Prior& prior() const { return prior_; }

  /// Discards the frames' linearization points. The prior is expressed about their present values, and every
  /// factor is linearized at the present values until the prior contains the frames again. Neither
  /// translations nor a rotation of everything about gravity become observable by it. This is for frames that
  /// may still move by as much as the baselines between them. For them, a landmark's derivative would be
  /// along the baseline from a linearization point to another frame's present value. That direction is
  /// arbitrary.
  void resetLinearizationPoints(Window& window);

  /// Adds external information on a parameter block: `sigmas` about its present value.
  void addKnowledge(ParameterBlock& state, const Eigen::VectorXd& sigmas) {
    prior_.append(state.value.data(), static_cast<int>(state.value.size()), sigmas);
  }
  /// Removes a parameter block from the prior and keeps the prior's information on the others. No factor of
  /// the window may contain the state any more. The state can be added again later.
  void forget(Window& window, ParameterBlock& state);

  const FactorBuilder& factors() const { return factors_; }

  /// Returns the landmarks that left the window since the last call, in order.
  std::vector<MapPoint> takeMapPoints() { return std::exchange(map_points_, {}); }

 private:
  /// Marginalizes the oldest frame with motion. A keyframe loses its motion block. Any other frame is
  /// removed, so that the prior stays small. Its observations stay where its pose can be interpolated
  /// (keyframe_policy.h); otherwise they are dropped.
  void marginalizeOldestFrame(Window& window, const WindowOptions& wanted);
  /// Adds the terms of sensors and rest that contain the oldest of two frames to `system`, and removes them
  /// from the frames.
  void addSensors(Window& window, Frame& oldest, Frame& next, NormalEquations* system) const;
  /// The same for the measurements of one frame, those relative to `before`, or the others where that is
  /// null.
  void addMeasurements(Window& window, Frame* before, Frame& frame, NormalEquations* system) const;
  /// Removes the oldest keyframe. Landmarks that the newest keyframe does not observe are marginalized with
  /// all their observations. The others are marginalized with their observations before a cut
  /// (WindowOptions). Where that would leave too few observations on either side, they lose those in the
  /// oldest keyframe and change to another host.
  void removeOldestKeyframe(Window& window, int split_at_keyframe);

  /// Computes the new prior from `system`, which contains the old prior and all terms of the eliminated
  /// blocks. Parameter blocks walk for `elapsed_s`.
  void eliminate(Window& window, const NormalEquations& system, const std::vector<const double*>& eliminated,
                 double elapsed_s = 0.0);

  const FactorBuilder& factors_;
  Prior prior_;
  std::vector<MapPoint> map_points_;
};

}  // namespace lodeline
