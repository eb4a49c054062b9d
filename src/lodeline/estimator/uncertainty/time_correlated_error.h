#pragma once

#include <algorithm>
#include <optional>

#include "lodeline/util/time/time.h"

namespace lodeline {

/// An error that is hardly another from one moment to the next; its correlation falls to 1/e in
/// `correlation_s`.
struct TimeCorrelatedError {
  double variance = 0.0;
  double correlation_s = 0.0;
};

/// Factor on the variance of an error that stays the same for `correlation_s`, by which frames at `now` and
/// `last` (none: long ago) can be taken for independent: over averages, such an error weighs like white noise
/// of density sigma sqrt(2 correlation_s).
inline double timeCorrelatedShare(Time now, const std::optional<Time>& last, double correlation_s) {
  const double longest_s = 2.0 * correlation_s;
  const double since_s = last ? (now - *last).seconds() : longest_s;
  return longest_s / std::clamp(since_s, 1e-3, longest_s);
}

}  // namespace lodeline
