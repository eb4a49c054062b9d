#pragma once

#include "lodeline/frontend/tracking/patch.h"

namespace lodeline {

/// When an alignment counts as the same point.
struct MatchQuality {
  double min_correlation = 0.85;
  /// In a dim picture noise alone lowers the correlation; what differs no more than the sensor's noise is
  /// accepted down to `min_correlation_in_noise`.
  double noise_grey = 2.0;
  double min_correlation_in_noise = 0.5;

  bool accepts(const PatchMatch& match) const {
    return match.correlation >= min_correlation ||
           (match.residual_grey <= noise_grey && match.correlation >= min_correlation_in_noise);
  }
};

}  // namespace lodeline
