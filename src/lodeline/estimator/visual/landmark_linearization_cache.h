#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "lodeline/factors/prior_factor.h"
#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/normal_equations.h"
#include "lodeline/problem/robust_loss.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Cached linearization of the landmarks that no recent frame observes, nor a frame that is interpolated with
/// a recent keyframe. These landmarks have half of a window's observations, lie between keyframes that hardly
/// move, and have their Jacobians at linearization points anyway. For some frames their terms, landmarks
/// eliminated, are replaced by the quadratic cost about the values of one frame. Then all of them are
/// linearized again.
class LandmarkLinearizationCache {
 public:
  /// The cache is valid for `most_frames` frames at most; 0: never.
  explicit LandmarkLinearizationCache(int most_frames) : most_frames_(most_frames) {}

  /// Caches landmarks last observed by the old keyframes or between them, at their present values
  /// (FeatureTrack::is_frozen). To be called after a frame that linearized all landmarks. Does nothing while
  /// the cache is in use.
  void freeze(Window& window, const FactorBuilder& factors);

  /// Empties the cache, before a frame is solved, if it is old enough. It also does so if a frame or
  /// block it depends on was removed or has a new linearization point. A block that has left the range
  /// of the quadratic cost empties it too.
  void invalidateIfStale(Window& window);

  /// Approximate terms of ReprojectionSystem for these landmarks at the blocks' present values: first order
  /// in the gradient, second order in the cost. 0 and no terms where the cache is empty.
  double cost() const;
  void addTo(NormalEquations* system) const;

  /// Residuals of their observations when they were cached.
  const std::vector<ObservationError>& errors() const { return errors_; }

 private:
  struct FrameThen {
    FrameId id;
    std::optional<PoseBlock> first_pose;
  };
  bool hold(const Window& window) const;
  bool haveMoved() const;
  void keep(const NormalEquations& system, const Window& window);
  /// Values of the blocks. Poses are relative to the newest of the keyframes, with that keyframe at its
  /// linearization point. A rigid motion of all poses does not change the landmarks' residuals. Without this
  /// transformation it would change the quadratic cost, which would then resist rotations that happened after
  /// its linearization.
  std::vector<Eigen::VectorXd> values() const;
  Eigen::VectorXd step() const;

  int most_frames_;
  int frames_ = 0;  ///< number of frames since
  Prior then_;      ///< blocks and their values() when they were cached; its other members are unused
  std::vector<NormalEquations::Block> blocks_;
  const double* reference_ = nullptr;  ///< pose of that keyframe
  Rigid3 first_reference_;
  Eigen::MatrixXd hessian_;
  Eigen::VectorXd gradient_;
  double cost_ = 0.0;
  std::vector<ObservationError> errors_;
  std::vector<FrameThen> old_frames_;
  std::vector<std::pair<TrackId, size_t>> tracks_;  ///< with the number of observations of each
  size_t parameter_blocks_ = 0;
};

}  // namespace lodeline
