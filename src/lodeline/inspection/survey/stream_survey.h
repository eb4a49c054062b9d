#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// A time span without readings.
struct StreamGap {
  Time after;
  double length_s = 0.0;
};

/// Properties of one sensor's time stamps.
struct StreamSummary {
  int64_t readings = 0;
  double rate_hz =
      0.0;  ///< the inverse of the median step, in bursts of the mean one; 0 with fewer than three readings
  double duration_s = 0.0;        ///< from the first to the last
  double jitter_s = 0.0;          ///< median deviation of the steps from the median step
  int64_t duplicates = 0;         ///< stamps equal to the one before
  int64_t backwards = 0;          ///< stamps before an earlier one
  int64_t clock_jumps = 0;        ///< of these, where the clock was set back
  int64_t repeated = 0;           ///< readings identical to the one before
  double longest_frozen_s = 0.0;  ///< longest span of identical readings
  double frozen_share = 0.0;      ///< of the duration, in spans of a second or longer of identical readings
  std::vector<StreamGap> gaps;    ///< longest first
  double gap_s = 0.0;             ///< all of them together
  std::optional<Time> first, last;
};

/// Collects the statistics of one stream as stored. Needs 8 bytes per reading.
class StreamSurvey {
 public:
  /// `repeats`: the reading is identical to the one before.
  void add(Time time, bool repeats = false);
  /// `gap_periods`: intervals of more periods than this count as gaps.
  StreamSummary summarize(double gap_periods) const;

 private:
  void closeFrozen();
  std::vector<Time> firstStamps() const;

  std::vector<Time> stamps_;
  StreamSummary counts_;
  std::optional<Time> frozen_since_;
  double frozen_s_ = 0.0;
  Time previous_;
};

}  // namespace lodeline
