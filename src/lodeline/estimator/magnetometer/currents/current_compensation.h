#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/ahrs/magnetometer_mean.h"
#include "lodeline/diagnostics.h"
#include "lodeline/estimator/magnetometer/currents/current_monitor.h"
#include "lodeline/estimator/magnetometer/currents/current_states.h"
#include "lodeline/estimator/sensor/batch_state.h"
#include "lodeline/magnetometer/currents/current_track.h"
#include "lodeline/problem/covariance.h"

namespace lodeline {

/// What is done about the currents in a frame.
enum class CurrentStatus {
  NoData,       ///< no current reading yet; readings of the magnetometer are used unchanged
  Missing,      ///< the currents of these readings are unknown (a gap): they are not used
  Compensated,  ///< by the calibration
  Held,         ///< the same or Learned, with the last currents before the readings, and a wider sigma
  Learned,      ///< by fields that this dive tells, without a calibration
  Refused,      ///< the same, because the dive contradicts the calibration
};
const char* toString(CurrentStatus status);

/// Removes the field of measured electric currents from a magnetometer's readings:
///
///   corrected reading = R_B_M A (reading - h) - sum_i k_i I_i,   k_i in body axes, T/A
///
/// The fields k_i are states of the window. Their marginalization prior is wide (kUnknownSigma). What the
/// calibration says of them is a prior beside it (ParameterBlock::priors). Where CurrentMonitor contradicts
/// the calibration, that prior is taken away, and nothing of it stays in the window. With more channels than
/// kMostStates the fields are constants, and their sigmas add to the noise.
class CurrentCompensation {
 public:
  static constexpr double kUnknownSigma_T_per_A = 1e-6;
  static constexpr size_t kMostStates = 12;

  /// `diagnostics` must outlive it.
  CurrentCompensation(const Rig& rig, Diagnostics* diagnostics);

  /// Whether the rig has current sensors; nothing else may be called without.
  bool isOnBoard() const { return !channels_.empty(); }

  /// Adds the current readings of a frame.
  void add(std::span<const CurrentSample> samples);
  /// The readings whose currents are known, and the means of these currents. Readings between two current
  /// readings are preferred.
  struct Known {
    std::vector<FieldSample> samples;
    CurrentsAt currents;
  };
  Known withCurrents(std::span<const FieldSample> samples, Time now);

  bool areStates() const { return channels_.size() <= kMostStates; }
  /// The states that have to be added at the start, with their present values.
  std::vector<ParameterBlock> states() const;
  /// Sigmas of a state for the prior at the start.
  static Vec3 stateSigmas() { return Vec3::Constant(kUnknownSigma_T_per_A); }
  std::vector<BatchState> batchStates(const Window& window) const;

  /// Field of the currents, T, body axes at the readings, with the window's states or the calibration.
  Vec3 field_B(const CurrentsAt& currents, const Window* window) const;
  /// Variance of that field per axis, T^2, by the covariance of the states, or the calibration's sigma.
  double fieldVariance_T2(const CurrentsAt& currents, const Window& window,
                          const JointCovariance& known) const;
  /// Variance per axis that is not in the states' covariance, T^2: of held currents, and of constants.
  double noiseVariance_T2(const CurrentsAt& currents) const;

  /// Compares with the calibration. `difference_B`: measured minus expected field without any compensation,
  /// with white noise of `white_variance_T2` per axis.
  /// Returns true where the calibration is refused now; `window` has lost its prior then.
  bool check(Time time, const CurrentsAt& currents, const Vec3& difference_B, double white_variance_T2,
             Window& window);

  CurrentStatus status() const { return status_; }
  /// Status, present field and its sigma, fields of all channels.
  std::vector<std::pair<std::string, std::string>> columns() const;
  /// Remembers what columns() says of a frame.
  void describe(const CurrentsAt& currents, const Window& window, const JointCovariance& known);

 private:
  bool isCalibrated() const { return !fields_B_.empty() && !is_refused_; }
  Vec3 calibrated_B(size_t channel) const { return isCalibrated() ? fields_B_[channel] : Vec3::Zero(); }
  double sigma_T_per_A() const { return isCalibrated() ? field_sigma_T_per_A_ : kUnknownSigma_T_per_A; }
  void reportMissing(Time now);

  Diagnostics* diagnostics_;
  std::vector<std::string> channels_;
  std::vector<Vec3> fields_B_;  ///< of the calibration; empty without
  double field_sigma_T_per_A_ = 0.0;
  CurrentTrack track_;
  CurrentMonitor monitor_;
  bool is_refused_ = false;
  CurrentStatus status_ = CurrentStatus::NoData;
  std::optional<Time> missing_since_;
  bool is_missing_reported_ = false;
  Vec3 shown_field_B_ = Vec3::Zero();
  double shown_sigma_T_ = 0.0;
  std::vector<Vec3> shown_fields_B_;
};

}  // namespace lodeline
