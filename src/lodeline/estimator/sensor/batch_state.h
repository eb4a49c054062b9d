#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/problem/state/parameter_block.h"

namespace lodeline {

/// How a parameter block of a sensor becomes part of the batch solution. Its initial value there is that at
/// the end of the run.
struct BatchState {
  std::string name;  ///< of the parameter block
  /// Walk of a state that is a chain of blocks, [unit of the block]/sqrt(s); empty: one constant block.
  std::optional<double> walk_per_sqrt_s = std::nullopt;
  /// Whether the chain begins anew with each restart of the sensor (SensorFusion::restarts).
  bool restarts = false;
  /// Sigma of each coordinate before the first measurement, about `value` (empty: about the initial value).
  double sigma = 0.0;
  std::vector<double> value = {};
  /// Whether the block is added after the start of the run in any case. The prior at the start then never
  /// contains it.
  bool is_added_late = false;
  /// Whether what the prior at the start says of it does not hold any more.
  bool is_start_replaced = false;
  std::vector<ScalarPrior> priors = {};  ///< ParameterBlock::priors at the end of the run
};

}  // namespace lodeline
