#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "lodeline/problem/options/magnetometer_options.h"
#include "lodeline/types.h"

namespace lodeline {

/// Detects steps of the field from currents on board that are switched, such as lamps, motors or the charger
/// of a strobe. The field at the sensor changes at once and then stays constant. Nothing else on a dive has
/// this signature: rock and tanks approach over seconds, residual iron turns with the rig, heading drifts
/// over minutes. The step is therefore measured with the accuracy of the sensor's white noise. Later readings
/// are corrected by it, so that it does not count as a rotation of the rig.
///
/// A step makes a channel of a current without a sensor: a field k in body axes, with a sigma, and a current
/// of 0 or 1. A later step of k, or of -k where it is on, is the same channel: the mean of all its steps
/// becomes k. A step that agrees with a channel needs less evidence than a new one. A step of -k where the
/// channel is off is the end of a current whose start was missed, and changes nothing.
///
/// The input is the difference of measured and expected field in body axes, in which the field of a current
/// on board is constant. A change in heading alone does not count as a step, because it may be a correction
/// of the estimator's heading.
class MagneticStepDetector {
 public:
  explicit MagneticStepDetector(const MagneticStepDetectorOptions& options) : options_(options) {}

  struct Change {
    Vec3 by_B = Vec3::Zero();  ///< T, from the previous to the present value of step_B()
    double sigma_T = 0.0;      ///< per axis
  };
  /// Magnetometer reading of one frame.
  struct Reading {
    Time time;
    Vec3 difference_B = Vec3::Zero();  ///< measured minus expected field, T, without correction by steps
    Vec3 heading_B = Vec3::UnitX();    ///< unit vector of the change of the difference by a heading error
    double white_variance_T2 = 0.0;    ///< per axis
    /// Whether the reading counts as the Earth's field. A step can start from such a field only.
    bool is_believed = true;
  };
  /// Gives the change where step_B() has changed.
  std::optional<Change> add(const Reading& reading);

  /// Sum of the fields of all channels that are on, T, body axes.
  const Vec3& step_B() const { return step_B_; }
  /// Number of different currents that were switched so far.
  size_t channels() const { return channels_.size(); }

 private:
  /// A possible step in the middle of the last four segments.
  struct Candidate {
    Vec3 step_B = Vec3::Zero();
    double besides_heading_T = 0.0;  ///< size of the part that is not along heading_B
    double variance_T2 = 0.0;        ///< white, per axis
    bool is_sharp = false;           ///< nearly constant before and after, and the field before was accepted
  };
  /// A current without a sensor.
  struct Channel {
    Vec3 field_B = Vec3::Zero();  ///< T, at a current of 1
    double variance_T2 = 0.0;     ///< per axis
    bool is_on = false;

    /// The step that its next switching makes.
    Vec3 nextStep_B() const { return is_on ? Vec3(-field_B) : field_B; }
  };
  std::optional<Candidate> candidate() const;
  /// Variance of the size of a step as measured, per axis.
  double measuredVariance_T2(const Candidate& step) const;
  /// Whether the step as measured is this one, of a channel.
  bool isStepOf(const Candidate& candidate, const Channel& channel, const Vec3& expected_B) const;
  /// The channel whose next step this is.
  Channel* find(const Candidate& candidate);
  /// Whether it is the end of a current whose start was missed.
  bool endsMissedStart(const Candidate& candidate) const;
  bool isKnownStep(const Candidate& candidate);
  /// Sets the sum of the channels and returns the change.
  Change sum(double sigma_T);
  bool isStep(const Candidate& candidate) const;
  void learnUsual(const Candidate& candidate, double since_s);
  std::optional<Change> settle(const Candidate& step);
  std::optional<Change> dropIfReturned(Time time);

  MagneticStepDetectorOptions options_;
  std::deque<Reading> readings_;   ///< of the last four segments
  std::optional<Candidate> best_;  ///< best candidate near the step under examination
  Time best_time_;
  std::vector<Channel> channels_;
  Vec3 step_B_ = Vec3::Zero();
  double usual_square_T2_ = 0.0;  ///< faded mean
  double usual_weight_s_ = 0.0;
  std::optional<Time> returned_since_;
};

}  // namespace lodeline
