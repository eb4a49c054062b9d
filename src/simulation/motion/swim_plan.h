#pragma once

#include <cstdint>
#include <vector>

namespace lodeline {

/// A time interval in which the rig is completely at rest, e.g. on a ledge.
struct StillPhase {
  double begin_s = 0.0;
  double duration_s = 0.0;
};

struct SwimPlanOptions {
  uint64_t seed = 1;
  double duration_s = 600.0;
  double penetration_m = 75.0;  ///< maximum arc length along the centreline
  bool round_trip = true;       ///< back to the start; otherwise end at the far end
  /// Changes of arc length between turns, m, in place of penetration and round trip; the signs alternate.
  std::vector<double> legs_m;
  bool starts_at_rest = true;  ///< at rest for `start_rest_s`; otherwise at cruising speed from the start
  double start_rest_s = 4.0;
  double turn_s = 10.0;           ///< hovering and turning at the far end, and at every other turn
  double stops_per_minute = 0.6;  ///< short halts of 4 to 10 s
  std::vector<StillPhase> still_phases;
};

/// Schedule of swimming, halts, turn and rests: progress along the centreline as functions of time, sampled
/// at 20 Hz. All other parts of a dive's motion depend on it.
class SwimPlan {
 public:
  /// Throws UsageError where length and duration require a mean swimming speed outside 0.05 to 0.6 m/s.
  explicit SwimPlan(const SwimPlanOptions& options);

  double arcLength(double time_s) const { return sampled(arc_length_m_, time_s); }
  /// Number of half turns made: 0 before the first turn, 1 after it.
  double turn(double time_s) const { return sampled(turn_, time_s); }
  /// Index of the leg: number of turns whose middle is past.
  int leg(double time_s) const;
  /// 0 while the rig is at rest, 1 while it is held.
  double activity(double time_s) const { return sampled(activity_, time_s); }
  /// 0 while hovering, 1 at full kick strength.
  double kick(double time_s) const { return sampled(kick_, time_s); }

  double meanSwimSpeed() const { return mean_speed_; }
  /// Of the first turn; after the end of a dive without turns.
  double turnBegin_s() const { return turn_begin_s_.front(); }
  double turnEnd_s() const { return turnBegin_s() + options_.turn_s; }

 private:
  struct Pause {
    double begin_s, end_s;
    bool still;
  };
  void scheduleTurns(double rest_s);
  std::vector<Pause> pauses() const;
  void addHalts(std::vector<Pause>& pauses) const;
  void integrateSpeed();
  double sampled(const std::vector<double>& values, double time_s) const;

  SwimPlanOptions options_;
  std::vector<double> legs_m_;
  std::vector<double> turn_begin_s_;  ///< of every turn, or one beyond the end
  double mean_speed_ = 0.0;
  std::vector<double> arc_length_m_, turn_, activity_, kick_;
};

}  // namespace lodeline
