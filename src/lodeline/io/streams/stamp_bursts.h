#pragma once

#include <optional>
#include <vector>

#include "lodeline/util/time/time.h"

namespace lodeline {

/// The mean period of a stream whose readings come in bursts: several stamped at nearly the same moment, on
/// arrival, then nothing for several periods. Also of stamps that are coarser than the period, so that
/// several readings share one. Nothing for a stream of single readings, whatever its jitter and losses.
std::optional<Duration> burstPeriod(const std::vector<Time>& stamps);

/// Gives the readings of a burst times that are spread out evenly since the burst before. The last reading of
/// a burst keeps its stamp: it is the one that had just been measured when the burst arrived.
class BurstSpreader {
 public:
  explicit BurstSpreader(Duration period) : period_(period) {}

  /// Whether a reading at `next` begins a new burst after one at `previous`.
  bool separates(Time previous, Time next) const;
  /// Times for the readings of one burst, whose stamps are given in order. To be called burst by burst.
  std::vector<Time> spread(const std::vector<Time>& burst);

 private:
  Duration period_;
  std::optional<Time> last_;  ///< of the burst before
};

}  // namespace lodeline
