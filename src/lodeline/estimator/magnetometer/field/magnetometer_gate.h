#pragma once

#include <optional>

#include "lodeline/estimate.h"
#include "lodeline/problem/options/magnetometer_options.h"
#include "lodeline/types.h"

namespace lodeline {

/// Measured minus expected field, with one sigma of each difference.
struct FieldCheck {
  double norm_error = 0.0, norm_sigma = 0.0;  ///< relative to the expected field
  double dip_error_rad = 0.0, dip_sigma_rad = 0.0;
  double heading_error_rad = 0.0, heading_sigma_rad = 0.0;
  double correlated_sigma_rad =
      0.0;  ///< sigma of the heading from this field by its time-correlated error (MagneticNoiseEstimator)
};

struct GateDecision {
  MagnetometerStatus status = MagnetometerStatus::NoData;
  bool use = false;
  bool begin_disturbance = false;  ///< from now on an unknown vector is added to the Earth's field
  bool end_disturbance = false;    ///< the Earth's field is undisturbed again
  /// Factor on the variance of a reading that is used although it disagrees slightly.
  double variance_scale = 1.0;
};

/// Decides for each frame whether a magnetometer measures the Earth's field:
/// - a field beyond the limits in norm, dip or heading is rejected;
/// - it is accepted again when it has stayed well within the limits for a while (hysteresis);
/// - the weight of accepted readings decreases with the share of the last minute in which the field was
///   rejected: a sensor with a wrong calibration agrees now and then;
/// - if the field is not accepted again within `readmission_s`, it is readmitted with a constant disturbance
///   to be estimated. No wrong decision then excludes the sensor permanently. The Earth's field stays a
///   state, and the disturbance ends as soon as the readings agree with the Earth's field again;
/// - the gate sums the times of agreement and of rejection. A good sensor with disturbances agrees for longer
///   than it disagrees. Otherwise its calibration is wrong, or a magnet is on board; then nothing is used
///   until agreement prevails or a retry is due.
class MagnetometerGate {
 public:
  explicit MagnetometerGate(const MagnetometerGateOptions& options) : options_(options) {}

  /// `earth`: compared with the Earth's field alone; `disturbed`: with the disturbance added, where there is
  /// one.
  GateDecision decide(Time time, const FieldCheck& earth, const std::optional<FieldCheck>& disturbed);

 private:
  enum class State { Trusting, Rejecting, Disturbed };

  /// The quantity that exceeds its limit times `share`; Used where none does.
  MagnetometerStatus verdict(const FieldCheck& check, double share) const;
  double varianceScale(const FieldCheck& check) const;
  /// Whether `check` has stayed within the tighter limits for long enough.
  bool released(Time time, const FieldCheck& check, std::optional<Time>* calm_since) const;
  GateDecision reject(Time time, MagnetometerStatus reason);
  GateDecision judge(Time time, const FieldCheck& earth, const std::optional<FieldCheck>& disturbed);
  /// Whether the sums of agreement and rejection, or the time-correlated error, show a wrong calibration.
  bool isInconsistent(const FieldCheck& earth) const;
  /// Whether a sensor that was Inconsistent may be used again.
  bool rehabilitated(Time time, const FieldCheck& earth);
  void keepAccount(MagnetometerStatus status, double since_s);
  /// Share of the recent past in which the magnetometer was rejected; readmission counts half.
  double doubt(const GateDecision& decision, double since_s);

  MagnetometerGateOptions options_;
  State state_ = State::Trusting;
  Time rejected_since_;
  std::optional<Time> earth_calm_since_, disturbed_calm_since_;
  std::optional<Time> last_time_;
  double doubt_ = 0.0;
  double agreed_s_ = 0.0, rejected_s_ = 0.0;  ///< faded
  std::optional<Time> distrusted_since_;
};

}  // namespace lodeline
