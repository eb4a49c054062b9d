#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/problem/normal_equations.h"
#include "lodeline/estimator/problem/robust_loss.h"
#include "lodeline/estimator/state/window.h"
#include "lodeline/factors/prior_factor.h"

namespace lodeline {

/// What landmarks that no recent frame sees any more, nor one that hangs on a recent one, say of poses and
/// calibration. They make half of a window's observations, lie between keyframes that hardly move, and have
/// their Jacobians taken at linearization points anyway: for some frames their terms, landmarks eliminated,
/// stand as the quadratic cost that they are about the values of one frame. Then all of them are evaluated
/// again.
class LandmarkLinearizationCache {
 public:
  /// They hold for `most_frames` frames at most; 0: never.
  explicit LandmarkLinearizationCache(int most_frames) : most_frames_(most_frames) {}

  /// At the end of a frame that evaluated all landmarks: puts those that were last seen by the old keyframes
  /// or between them to sleep (FeatureTrack::is_frozen) at their present values. Does nothing while some are
  /// asleep.
  void freeze(Window& window, const FactorBuilder& factors);

  /// Before a frame is solved: wakes them all where they have slept for long enough, where what they hang on
  /// has been removed or linearized anew, or where it has moved by more than a quadratic cost is good for.
  void invalidateIfStale(Window& window);

  /// What ReprojectionSystem would say of them at the blocks' present values: to first order of the change
  /// since they were put to sleep in the gradient, to second order in the cost. 0 and no terms where none is
  /// asleep.
  double cost() const;
  void addTo(NormalEquations* system) const;

  /// Of their observations when they were put to sleep.
  const std::vector<ObservationError>& errors() const { return errors_; }

 private:
  struct FrameThen {
    FrameId id;
    std::optional<PoseBlock> first_pose;
  };
  bool hold(const Window& window) const;
  bool haveMoved() const;
  void keep(const NormalEquations& system, const Window& window);
  /// Of the blocks, with poses as seen from the newest of the keyframes and that one put where it was first
  /// estimated. Where all of them lie makes no difference to what landmarks say, but it would to a quadratic
  /// cost that was linearized elsewhere: one that resists every turn of what has turned since then.
  std::vector<Eigen::VectorXd> values() const;
  Eigen::VectorXd step() const;

  int most_frames_;
  int frames_ = 0;  ///< that they have slept for
  Prior then_;      ///< blocks and their values() when they were put to sleep; nothing else of it is used
  std::vector<NormalEquations::Block> blocks_;
  const double* reference_ = nullptr;  ///< the pose of that keyframe
  Rigid3 first_reference_;
  Eigen::MatrixXd hessian_;
  Eigen::VectorXd gradient_;
  double cost_ = 0.0;
  std::vector<ObservationError> errors_;
  std::vector<FrameThen> old_frames_;
  std::vector<std::pair<TrackId, size_t>> tracks_;  ///< and how many observations each has
  size_t parameter_blocks_ = 0;
};

}  // namespace lodeline
