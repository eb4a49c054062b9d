#pragma once

#include <deque>
#include <optional>

#include "lodeline/estimator/options/magnetometer_options.h"
#include "lodeline/geometry/types.h"
#include "lodeline/util/time/time.h"

namespace lodeline {

/// Finds currents on board that are switched - lamps, motors, a strobe's charger -, whose field at the sensor
/// changes from one moment to the next and then stays. Nothing else on a dive does that: rock and tanks
/// come near over seconds, iron that calibration left turns with the rig, heading drifts over minutes. So a
/// change is known to the sensor's white noise, and what is measured after it can be corrected by it instead
/// of being taken for a turn of the rig.
///
/// Works on the difference of measured and expected field in body axes, which a current on board keeps. A
/// change that shows in heading alone is left to the estimator: it may be its own correction.
class MagneticStepDetector {
 public:
  explicit MagneticStepDetector(const MagneticStepDetectorOptions& options) : options_(options) {}

  struct Change {
    Vec3 by_B = Vec3::Zero();  ///< T, from what step_B() was to what it is
    double sigma_T = 0.0;      ///< per axis
  };
  /// What a frame's magnetometer saw.
  struct Reading {
    Time time;
    Vec3 difference_B = Vec3::Zero();  ///< measured less expected field, T, with no step taken off
    Vec3 heading_B = Vec3::UnitX();    ///< unit vector along which an error of heading shows in it
    double white_variance_T2 = 0.0;    ///< per axis
    /// Whether it counts as the Earth's, without which nothing can step from it.
    bool is_believed = true;
  };
  /// Says so where step_B() has changed.
  std::optional<Change> add(const Reading& reading);

  /// What switching has added to the field since the beginning, T, body axes.
  const Vec3& step_B() const { return step_B_; }

 private:
  /// A possible step in the middle of the last four segments.
  struct Candidate {
    Vec3 step_B = Vec3::Zero();
    double besides_heading_T = 0.0;  ///< size of what is not along heading_B
    double variance_T2 = 0.0;        ///< white, per axis
    bool is_sharp = false;  ///< nearly nothing changes before and after, and the field before was believed
  };
  std::optional<Candidate> candidate() const;
  bool isStep(const Candidate& candidate) const;
  void learnUsual(const Candidate& candidate, double since_s);
  std::optional<Change> settle(const Candidate& step);
  std::optional<Change> dropIfReturned(Time time);

  MagneticStepDetectorOptions options_;
  std::deque<Reading> readings_;   ///< of the last four segments
  std::optional<Candidate> best_;  ///< of those around the step that is coming through
  Time best_time_;
  Vec3 step_B_ = Vec3::Zero();
  double usual_square_T2_ = 0.0;  ///< faded mean
  double usual_weight_s_ = 0.0;
  std::optional<Time> returned_since_;
};

}  // namespace lodeline
