#include "lodeline/estimator/magnetometer/field/magnetometer_gate.h"

#include <algorithm>
#include <cmath>

namespace lodeline {

const char* toString(HeadingReference reference) {
  switch (reference) {
    case HeadingReference::True:
      return "true north";
    case HeadingReference::Magnetic:
      return "magnetic north";
    case HeadingReference::Automatic:
    case HeadingReference::Start:
      return "start heading";
  }
  return "unknown";
}

const char* toString(MagnetometerStatus status) {
  switch (status) {
    case MagnetometerStatus::Off:
      return "off";
    case MagnetometerStatus::NoData:
      return "no data";
    case MagnetometerStatus::Used:
      return "used";
    case MagnetometerStatus::Norm:
      return "norm";
    case MagnetometerStatus::Dip:
      return "dip";
    case MagnetometerStatus::Innovation:
      return "innovation";
    case MagnetometerStatus::Readmitted:
      return "readmitted";
    case MagnetometerStatus::Inconsistent:
      return "inconsistent";
    case MagnetometerStatus::Uncalibrated:
      return "uncalibrated";
  }
  return "unknown";
}

MagnetometerStatus MagnetometerGate::verdict(const FieldCheck& check, double share) const {
  const auto within = [&](double error, double sigma, double least) {
    return std::abs(error) <= share * std::max(least, options_.max_sigmas * sigma);
  };
  if (!within(check.norm_error, check.norm_sigma, options_.max_norm_error)) return MagnetometerStatus::Norm;
  if (!within(check.dip_error_rad, check.dip_sigma_rad, options_.max_dip_error_rad))
    return MagnetometerStatus::Dip;
  if (!within(check.heading_error_rad, check.heading_sigma_rad, 0.0)) return MagnetometerStatus::Innovation;
  return MagnetometerStatus::Used;
}

double MagnetometerGate::varianceScale(const FieldCheck& check) const {
  // From half the limit on, a disagreement increases the variance of the reading, so that a slowly growing
  // error loses weight before it is rejected.
  const double doubtful = 0.5 * options_.max_sigmas * check.heading_sigma_rad;
  const double ratio = check.heading_error_rad / doubtful;
  return std::max(1.0, ratio * ratio);
}

bool MagnetometerGate::released(Time time, const FieldCheck& check, std::optional<Time>* calm_since) const {
  if (verdict(check, options_.release_share) != MagnetometerStatus::Used) {
    calm_since->reset();
    return false;
  }
  if (!*calm_since) *calm_since = time;
  return (time - **calm_since).seconds() >= options_.release_s;
}

GateDecision MagnetometerGate::reject(Time time, MagnetometerStatus reason) {
  state_ = State::Rejecting;
  rejected_since_ = time;
  earth_calm_since_.reset();
  disturbed_calm_since_.reset();
  return {reason};
}

GateDecision MagnetometerGate::decide(Time time, const FieldCheck& earth,
                                      const std::optional<FieldCheck>& disturbed) {
  const double since_s = last_time_ ? (time - *last_time_).seconds() : 0.0;
  last_time_ = time;
  if (distrusted_since_ && !rehabilitated(time, earth)) {
    keepAccount(verdict(earth, options_.release_share), since_s);
    return {MagnetometerStatus::Inconsistent};
  }
  GateDecision decision = judge(time, earth, disturbed);
  keepAccount(decision.status, since_s);
  if (isInconsistent(earth)) {
    distrusted_since_ = time;
    decision = reject(time, MagnetometerStatus::Inconsistent);
    decision.end_disturbance = disturbed.has_value();
    return decision;
  }
  decision.variance_scale *= std::pow(1.0 - doubt(decision, since_s), -4);
  return decision;
}

void MagnetometerGate::keepAccount(MagnetometerStatus status, double since_s) {
  const double kept = std::exp(-since_s / options_.rejection_window_s);
  agreed_s_ *= kept;
  rejected_s_ *= kept;
  // A readmitted field is consistent with itself only, so it counts neither way.
  if (status == MagnetometerStatus::Readmitted) return;
  (status == MagnetometerStatus::Used ? agreed_s_ : rejected_s_) += since_s;
}

bool MagnetometerGate::isInconsistent(const FieldCheck& earth) const {
  return rejected_s_ > options_.max_rejected_ratio * agreed_s_ + options_.rejection_margin_s ||
         earth.correlated_sigma_rad > options_.max_correlated_sigma_rad;
}

bool MagnetometerGate::rehabilitated(Time time, const FieldCheck& earth) {
  const bool prevails = agreed_s_ > rejected_s_ + options_.rejection_margin_s && !isInconsistent(earth);
  if (!prevails && (time - *distrusted_since_).seconds() < options_.retry_after_s) return false;
  distrusted_since_.reset();
  if (!prevails) agreed_s_ = rejected_s_ = 0.0;
  rejected_since_ = time;
  return true;
}

double MagnetometerGate::doubt(const GateDecision& decision, double since_s) {
  constexpr double kMost = 0.9;
  const double now = !decision.use ? 1.0 : decision.status == MagnetometerStatus::Readmitted ? 0.5 : 0.0;
  doubt_ += (now - doubt_) * (1.0 - std::exp(-since_s / options_.memory_s));
  return std::min(doubt_, kMost);
}

GateDecision MagnetometerGate::judge(Time time, const FieldCheck& earth,
                                     const std::optional<FieldCheck>& disturbed) {
  GateDecision decision;
  const MagnetometerStatus against_earth = verdict(earth, 1.0);
  if (state_ == State::Trusting) {
    if (against_earth != MagnetometerStatus::Used) return reject(time, against_earth);
    return {MagnetometerStatus::Used, true, false, false, varianceScale(earth)};
  }
  if (released(time, earth, &earth_calm_since_)) {
    state_ = State::Trusting;
    return {MagnetometerStatus::Used, true, false, disturbed.has_value(), varianceScale(earth)};
  }
  if (state_ == State::Disturbed) {
    const MagnetometerStatus against_disturbed = verdict(*disturbed, 1.0);
    if (against_disturbed != MagnetometerStatus::Used) return reject(time, against_disturbed);
    return {MagnetometerStatus::Readmitted, true, false, false, varianceScale(*disturbed)};
  }
  if (disturbed && released(time, *disturbed, &disturbed_calm_since_)) {
    state_ = State::Disturbed;
    return {MagnetometerStatus::Readmitted, true, false, false, varianceScale(*disturbed)};
  }
  if ((time - rejected_since_).seconds() >= options_.readmission_s) {
    state_ = State::Disturbed;
    return {MagnetometerStatus::Readmitted, true, true, false, 1.0};
  }
  decision.status =
      against_earth == MagnetometerStatus::Used ? MagnetometerStatus::Innovation : against_earth;
  return decision;
}

}  // namespace lodeline
