#pragma once

#include <optional>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Mean period of a stream whose readings arrive in bursts: several readings get nearly the same stamp on
/// arrival, followed by a pause of several periods. It also applies to stamps coarser than the period, so
/// that several readings share one. Returns nothing for a stream of single readings, with any jitter and
/// losses.
std::optional<Duration> burstPeriod(const std::vector<Time>& stamps);

/// Spreads the readings of a burst evenly over the time since the previous burst. The last reading of a burst
/// keeps its stamp because it was measured just before the burst arrived.
class BurstSpreader {
 public:
  explicit BurstSpreader(Duration period) : period_(period) {}

  /// Whether a reading at `next` begins a new burst after one at `previous`.
  bool separates(Time previous, Time next) const;
  /// Times for the readings of one burst, whose stamps are given in order. Call it burst by burst.
  std::vector<Time> spread(const std::vector<Time>& burst);

 private:
  Duration period_;
  std::optional<Time> last_;  ///< last time of the previous burst
};

}  // namespace lodeline
