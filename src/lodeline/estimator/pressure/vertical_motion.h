#pragma once

#include <deque>

#include "lodeline/util/time/time.h"

namespace lodeline {

/// The recent vertical speed of a point of the rig, piecewise linear, from which follows how far it has
/// risen. Speeds rather than heights, because an estimated height may jump where an estimated speed does not.
class VerticalMotion {
 public:
  /// `speed_m_per_s`: upwards. In order of time; a time at or before the last one replaces it.
  void add(Time time, double speed_m_per_s);
  bool empty() const { return speeds_.empty(); }

  /// How much higher the point is at `to` than a sensor shows it at `from`, m, if the sensor follows with a
  /// first-order lag; a lag of 0 or less counts as a shift in time. Where no speed is known, that of the
  /// nearest moment holds between `from` and `to`, and the point stood still before the first moment.
  double riseSince(Time from, Time to, double lag_s) const;
  /// How much higher the point is at `to` than at `from` by what such a sensor shows.
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
