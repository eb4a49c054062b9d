#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/factors/parameters.h"

namespace lodeline {

/// An estimated quantity of the window that belongs to no frame: a field vector, a sensor's offset,
/// extrinsics, a time offset. Factors refer to its block like to that of a frame; solver, normal equations,
/// marginalization (with its linearization points) and covariance treat both alike. It enters with its own
/// entry in the prior (Prior::append), or with factors that determine it.
struct ParameterBlock {
  std::string name;
  /// Parameter block, never resized, so that its address identifies the state. A block of kPoseSize is a pose
  /// with its 6 perturbation coordinates; for any other, a perturbation is added.
  std::vector<double> value;
  /// Linearization point, set by the marginalization prior; empty while the prior does not contain the block.
  std::optional<std::vector<double>> first;
  /// Random walk of each coordinate, [unit of the block]/sqrt(s), applied to the prior as frames are
  /// marginalized. 0: a constant.
  double walk_per_sqrt_s = 0.0;
  /// Whether JointCovariance contains it; this costs as many more columns to solve for.
  bool is_correlation_wanted = false;
  /// Variance of a sudden change of each coordinate, [unit of the block]^2. It is added to the walk when the
  /// next frame is marginalized.
  double sudden_variance = 0.0;
  /// Prior of each coordinate beside the measurements (infinite sigma: none); empty: none for all. It may
  /// change from frame to frame, so it never becomes part of the marginalization prior.
  std::vector<ScalarPrior> priors = {};

  bool isPose() const { return value.size() == kPoseSize; }
  int tangentSize() const { return isPose() ? kPoseTangentSize : static_cast<int>(value.size()); }
  const double* linearizationPoint() const { return first ? first->data() : nullptr; }
};

}  // namespace lodeline
