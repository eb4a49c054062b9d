#pragma once

#include "lodeline/frontend/tracking/patch.h"

namespace lodeline {

/// Limits within which an alignment counts as the same point.
struct MatchQuality {
  double min_correlation = 0.85;
  /// In a dim image noise alone reduces the correlation. If the residual is not larger than this noise of the
  /// sensor, a correlation down to `min_correlation_in_noise` is accepted.
  double noise_grey = 2.0;
  double min_correlation_in_noise = 0.5;

  bool accepts(const PatchMatch& match) const {
    return match.correlation >= min_correlation ||
           (match.residual_grey <= noise_grey && match.correlation >= min_correlation_in_noise);
  }
};

}  // namespace lodeline
