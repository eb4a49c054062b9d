#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/factors/parameters.h"

namespace lodeline {

/// A number as it is believed to be: a normal distribution.
struct ScalarPrior {
  double value = 0.0, sigma = 0.0;
};

/// A quantity that the window estimates but that belongs to no frame: a field vector, a sensor's offset, an
/// extrinsic calibration, a time offset. Factors name its block like that of a frame; solver, normal
/// equations, marginalization (with its linearization points) and covariance treat it alike. It enters with
/// an entry of its own in the prior (Prior::append), or with factors that determine it.
struct ParameterBlock {
  std::string name;
  /// Parameter block, never resized, so that its address is the state's identity. A block of kPoseSize is a
  /// pose with its 6 perturbation coordinates; any other moves by addition.
  std::vector<double> value;
  /// Where the marginalization prior first linearized it; empty while the prior does not touch it.
  std::optional<std::vector<double>> first;
  /// Random walk of each coordinate, [unit of the block]/sqrt(s): what the prior knows of the state fades by
  /// this as frames are marginalized. 0: a constant.
  double walk_per_sqrt_s = 0.0;
  /// Whether JointCovariance shall hold it, at the price of as many more columns to solve for.
  bool is_correlation_wanted = false;
  /// Of a change that has happened all at once, each coordinate, [unit of the block]^2: joins the walk when
  /// the next frame is marginalized.
  double sudden_variance = 0.0;
  /// What is known of each coordinate beside all that the window was told (an infinite sigma: nothing);
  /// empty: of none. May change from frame to frame, so it never becomes part of the prior.
  std::vector<ScalarPrior> priors = {};

  bool isPose() const { return value.size() == kPoseSize; }
  int tangentSize() const { return isPose() ? kPoseTangentSize : static_cast<int>(value.size()); }
  const double* linearizationPoint() const { return first ? first->data() : nullptr; }
};

}  // namespace lodeline
