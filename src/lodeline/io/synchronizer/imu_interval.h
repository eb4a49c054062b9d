#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "lodeline/io/streams/ordered_stream.h"
#include "lodeline/io/streams/time_span.h"
#include "lodeline/rig.h"
#include "lodeline/util/time/time_steps.h"

namespace lodeline {

/// Linear interpolation of both vectors between two readings at `time`.
ImuSample interpolate(const ImuSample& before, const ImuSample& after, Time time);

/// Divides the stream of inertial readings at the image times.
class ImuIntervals {
 public:
  using Pull = std::function<std::optional<ImuSample>()>;

  /// `pull` gives readings in order of time; `history_s`: length kept before the first cut.
  ImuIntervals(Pull pull, double history_s) : pull_(std::move(pull)), history_s_(history_s) {}

  enum class Coverage { Covered, BeforeFirst, AfterLast };

  /// Reads until a reading at or after `time`, and returns whether `time` is within the readings. Times must
  /// not decrease from call to call.
  Coverage readUntil(Time time);

  /// The readings from the last cut (at the first cut, from the start of the history) to `time`, interpolated
  /// at both ends. `longest_gap_s` receives the longest time between real readings that overlaps this
  /// interval. Every sample keeps the time between the real readings around it (ImuSample::gap_s). `time`
  /// must be covered and later than the previous cut.
  std::vector<ImuSample> cut(Time time, double* longest_gap_s);

  /// Start and end of the longest time between two real readings in (from, to], as read so far. Returns
  /// nothing where there are fewer than two.
  struct Gap {
    Time begin, end;
    Duration length() const { return lodeline::span(end, begin); }
  };
  std::optional<Gap> longestGap(Time from, Time to) const;
  /// Shifts the readings from `from` on, which was already read, because their clock jumped there.
  void shiftFrom(Time from, Duration by);
  /// Reads the stream to its end and discards the readings, for messages about streams that do not overlap.
  void drain();

  /// Time span of the readings read so far.
  const std::optional<TimeSpan>& span() const { return span_.get(); }
  /// The last reading read so far.
  std::optional<Time> last() const { return last_; }

  /// The readings from the last cut to `time`, interpolated at both ends; the next cut returns them again.
  /// Returns nothing where they do not reach `time`.
  std::vector<ImuSample> ahead(Time time);

  /// Number of readings held at present.
  size_t size() const { return buffer_.size(); }

 private:
  Pull pull_;
  double history_s_;
  bool cut_before_ = false;
  /// Real readings, oldest first. After a cut, the first one is the last reading at or before it.
  std::deque<ImuSample> buffer_;
  ImuSample border_;  ///< the interpolated reading at the last cut
  std::optional<Time> last_;
  SpanOfStream span_;
  Duration correction_;  ///< correction of the unread part
};

}  // namespace lodeline
