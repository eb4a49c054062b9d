#pragma once

#include <optional>

#include "lodeline/estimator/options/magnetometer_options.h"
#include "lodeline/util/time/time.h"

namespace lodeline {

/// What became of the magnetometer in one frame.
enum class MagnetometerStatus {
  Off,           ///< not asked for, or not on board
  NoData,        ///< no usable reading since the frame before
  Used,          ///< taken for the Earth's field
  Norm,          ///< rejected: field of another size
  Dip,           ///< rejected: field of another inclination
  Innovation,    ///< rejected: heading disagrees with gyroscope and images
  Readmitted,    ///< rejected for so long that its field counts as a new one, whose disturbance is estimated
  Inconsistent,  ///< rejected as a whole: it has disagreed for longer than it has agreed
  Uncalibrated,  ///< not used because nobody knows its iron
};
const char* toString(MagnetometerStatus status);

/// A measured field against the expected one, with one sigma of each difference.
struct FieldCheck {
  double norm_error = 0.0, norm_sigma = 0.0;  ///< relative to the expected field
  double dip_error_rad = 0.0, dip_sigma_rad = 0.0;
  double heading_error_rad = 0.0, heading_sigma_rad = 0.0;
  double correlated_sigma_rad =
      0.0;  ///< of a heading from this field, by what MagneticNoiseEstimator has learned
};

struct GateDecision {
  MagnetometerStatus status = MagnetometerStatus::NoData;
  bool use = false;
  bool begin_disturbance = false;  ///< from now on the field differs from the Earth's by an unknown vector
  bool end_disturbance = false;    ///< the Earth's field is back
  /// Factor on the variance of a reading that is used though it disagrees somewhat.
  double variance_scale = 1.0;
};

/// Decides frame by frame whether a magnetometer sees the Earth's field:
/// - beyond the limits in norm, dip or heading it is rejected;
/// - it is believed again when it has stayed well within them for a while (hysteresis);
/// - what it then says weighs the less the larger a share of the last minute it was rejected: a sensor whose
///   calibration is wrong looks right now and then;
/// - if that does not happen for `readmission_s`, its field is readmitted as one that is disturbed by a
///   constant to be estimated, so that no wrong decision locks it out for good. The Earth's field is kept in
///   mind, and as soon as it is seen again the disturbance is over;
/// - it keeps account of how long the field agreed and how long it did not. What disagrees for longer than it
///   agrees is no disturbance of a good sensor: its calibration is wrong, or a magnet is on board. Then
///   nothing is used until agreement prevails, or until it is time for a new trial.
class MagnetometerGate {
 public:
  explicit MagnetometerGate(const MagnetometerGateOptions& options) : options_(options) {}

  /// `earth`: against the Earth's field alone; `disturbed`: with the disturbance added, where one was begun.
  GateDecision decide(Time time, const FieldCheck& earth, const std::optional<FieldCheck>& disturbed);

 private:
  enum class State { Trusting, Rejecting, Disturbed };

  /// What is wrong with the field when the limits are taken times `share`; Used for nothing.
  MagnetometerStatus verdict(const FieldCheck& check, double share) const;
  double varianceScale(const FieldCheck& check) const;
  /// Whether `check` has been within the tighter limits for long enough.
  bool released(Time time, const FieldCheck& check, std::optional<Time>* calm_since) const;
  GateDecision reject(Time time, MagnetometerStatus reason);
  GateDecision judge(Time time, const FieldCheck& earth, const std::optional<FieldCheck>& disturbed);
  /// By its account.
  bool isInconsistent(const FieldCheck& earth) const;
  /// While the sensor is not believed at all; whether that is over.
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
