#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "lodeline/io/streams/ordered_stream.h"
#include "lodeline/io/streams/time_span.h"
#include "lodeline/sensors/measurements.h"
#include "lodeline/util/time/time_steps.h"

namespace lodeline {

/// A reading at `time` between two others, linear in both vectors.
ImuSample interpolate(const ImuSample& before, const ImuSample& after, Time time);

/// Cuts the stream of inertial readings at the times of images.
class ImuIntervals {
 public:
  using Pull = std::function<std::optional<ImuSample>()>;

  /// `pull` gives readings in order of time; `history_s`: how much is kept from before the first cut.
  ImuIntervals(Pull pull, double history_s) : pull_(std::move(pull)), history_s_(history_s) {}

  enum class Coverage { Covered, BeforeFirst, AfterLast };

  /// Reads on until a reading at or after `time` has come; says whether `time` lies within the readings.
  /// Times must not decrease from call to call.
  Coverage readUntil(Time time);

  /// The readings from the last cut (at the first cut, from the start of the history) to `time`, both ends
  /// interpolated, and the longest time between true readings that this interval touches. Every sample keeps
  /// the time between the true readings around it (ImuSample::gap_s). Only for a covered time, later than the
  /// cut before.
  std::vector<ImuSample> cut(Time time, double* longest_gap_s);

  /// The longest time between two true readings in (from, to] as read so far, as its two ends; nothing where
  /// fewer than two are there.
  struct Gap {
    Time begin, end;
    Duration length() const { return lodeline::span(end, begin); }
  };
  std::optional<Gap> longestGap(Time from, Time to) const;
  /// Moves the readings from `from` on, which was read already, by so much: their clock jumped there.
  void shiftFrom(Time from, Duration by);
  /// Reads the stream to its end; what is read is lost. For messages about streams that do not meet.
  void drain();

  /// Of the readings read so far.
  const std::optional<TimeSpan>& span() const { return span_.get(); }
  /// The last reading read so far.
  std::optional<Time> last() const { return last_; }

  /// The readings from the last cut to `time`, both ends interpolated, which stay for the next cut; nothing
  /// where they do not reach so far.
  std::vector<ImuSample> ahead(Time time);

  /// Readings held at present.
  size_t size() const { return buffer_.size(); }

 private:
  Pull pull_;
  double history_s_;
  bool cut_before_ = false;
  /// True readings, oldest first. After a cut the first one is the last at or before it.
  std::deque<ImuSample> buffer_;
  ImuSample border_;  ///< the interpolated reading at the last cut
  std::optional<Time> last_;
  SpanOfStream span_;
  Duration correction_;  ///< of what is still to be read
};

}  // namespace lodeline
