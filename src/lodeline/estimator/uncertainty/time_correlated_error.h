#pragma once

#include <algorithm>
#include <optional>

#include "lodeline/types.h"

namespace lodeline {

/// An error that changes slowly: a variance and an exponential correlation that falls to 1/e within
/// `correlation_s`.
struct TimeCorrelatedError {
  double variance = 0.0;
  double correlation_s = 0.0;
};

/// Factor on the variance of an error with correlation time `correlation_s`, with which frames at `now` and
/// `last` (empty: long ago) can be treated as independent. Factor: 2 correlation_s / (now - last), at least
/// 1. Over averages, such an error weighs like white noise of density sigma sqrt(2 correlation_s).
inline double timeCorrelatedShare(Time now, const std::optional<Time>& last, double correlation_s) {
  const double longest_s = 2.0 * correlation_s;
  const double since_s = last ? (now - *last).seconds() : longest_s;
  return longest_s / std::clamp(since_s, 1e-3, longest_s);
}

}  // namespace lodeline
