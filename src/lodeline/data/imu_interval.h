#pragma once

#include <deque>
#include <vector>

#include "lodeline/data/ordered_stream.h"
#include "lodeline/sensors/measurements.h"

namespace lodeline {

/// A reading at `time` between two others, linear in both vectors.
ImuSample interpolate(const ImuSample& before, const ImuSample& after, Time time);

/// Cuts the stream of inertial readings at the times of images.
class ImuIntervals {
 public:
  /// `history_s`: how much is kept from before the first cut.
  ImuIntervals(OrderedStream<ImuSample> stream, double history_s)
      : stream_(std::move(stream)), history_s_(history_s) {}

  enum class Coverage { Covered, BeforeFirst, AfterLast };

  /// Reads on until a reading at or after `time` has come; says whether `time` lies within the readings.
  /// Times must not decrease from call to call.
  Coverage readUntil(Time time);

  /// The readings from the last cut (at the first cut, from the start of the history) to `time`, both ends
  /// interpolated, and the longest time between true readings that this interval touches. Only for a covered
  /// time, later than the cut before.
  std::vector<ImuSample> cut(Time time, double* longest_gap_s);

  /// The readings from the last cut to `time`, both ends interpolated, which stay for the next cut; nothing
  /// where they do not reach so far.
  std::vector<ImuSample> ahead(Time time);

  /// Readings held at present.
  size_t size() const { return buffer_.size(); }

 private:
  OrderedStream<ImuSample> stream_;
  double history_s_;
  bool cut_before_ = false;
  /// True readings, oldest first. After a cut the first one is the last at or before it.
  std::deque<ImuSample> buffer_;
  ImuSample border_;  ///< the interpolated reading at the last cut
};

}  // namespace lodeline
