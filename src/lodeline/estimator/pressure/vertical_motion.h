#pragma once

#include <deque>

#include "lodeline/types.h"

namespace lodeline {

/// Recent vertical speed of a point of the rig, piecewise linear; its integral is the rise of the point. It
/// stores speeds rather than heights, because an estimated height may jump where an estimated speed does not.
class VerticalMotion {
 public:
  /// `speed_m_per_s`: upwards. Entries come in order of time; a time at or before the last one replaces it.
  void add(Time time, double speed_m_per_s);
  bool empty() const { return speeds_.empty(); }

  /// Height of the point at `to` minus the height that a sensor shows at `from`, m. The sensor follows with a
  /// first-order lag; a lag of 0 or less counts as a time shift. Outside the known speeds, the nearest one
  /// holds between `from` and `to`. Before the first time, the point is at rest.
  double riseSince(Time from, Time to, double lag_s) const;
  /// Height of the point at `to` minus its height at `from`, both as such a sensor shows them.
  double shownRise(Time from, Time to, double lag_s) const {
    return riseSince(from, to, lag_s) - riseSince(to, to, lag_s);
  }

 private:
  double speedAt(Time time) const;
  double risen(Time from, Time to) const;

  struct Speed {
    Time time;
    double speed_m_per_s = 0.0;
  };
  std::deque<Speed> speeds_;
};

}  // namespace lodeline
