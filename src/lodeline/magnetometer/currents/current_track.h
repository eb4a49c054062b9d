#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "lodeline/rig.h"

namespace lodeline {

/// Currents of some channels at a time, A.
struct CurrentsAt {
  Eigen::VectorXd currents_A;
  /// One sigma of the interpolation; zero between two readings.
  Eigen::VectorXd sigmas_A;

  bool isMeasured() const { return sigmas_A.isZero(0.0); }
};

/// Measured currents as a function of time. Between two readings they are linear in time. After the newest
/// reading they keep its value, with a sigma: the usual (root mean square) change from one reading to the
/// next in proportion to the time since then.
class CurrentTrack {
 public:
  /// `longest_gap_s`: longest time between two readings over which currents are known, and longest time after
  /// the newest.
  CurrentTrack(size_t channels, double longest_gap_s) : channels_(channels), longest_gap_s_(longest_gap_s) {}

  /// Adds a reading, on the clock of the IMU. Returns false, and keeps nothing, for a reading with another
  /// number of channels, a value that is not finite, or no later time.
  bool add(const CurrentSample& sample);

  /// Forgets what only times before `time` need.
  void forgetBefore(Time time);

  /// Nothing before the first reading, within a gap, and where there is no reading for longer than a gap.
  std::optional<CurrentsAt> at(Time time) const;

  bool empty() const { return readings_.empty(); }

 private:
  struct Reading {
    Time time;
    Eigen::VectorXd currents_A;
  };

  size_t channels_;
  double longest_gap_s_;
  std::deque<Reading> readings_;
  Eigen::VectorXd usual_square_A2_;  ///< faded mean square of the changes from reading to reading
  double usual_period_s_ = 0.0;      ///< faded mean of the times between readings
};

}  // namespace lodeline
