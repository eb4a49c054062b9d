#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "lodeline/rig.h"
#include "simulation/shared/motion.h"

namespace lodeline {

/// Electric currents of a vehicle with thrusters and a lamp, and the field that they add to the raw readings
/// of a magnetometer.
struct TrialCurrentOptions {
  int thrusters = 8;
  double largest_A = 20.0;                     ///< of a thruster
  double field_T_per_A = 0.45e-6;              ///< size of k of each thruster: 9 uT at 20 A
  double rate_hz = 10.0;                       ///< of the current sensor
  bool has_sensor = true;                      ///< whether the estimator gets current readings
  bool is_calibrated = true;                   ///< whether its rig states fields
  double calibration_sigma_T_per_A = 0.01e-6;  ///< error of these, drawn, and as stated
  double moved_rad = 0.0;                 ///< rotation of the true fields after the calibration: cables moved
  double gap_begin_s = 0.0, gap_s = 0.0;  ///< without readings of currents
};

class TrialCurrents {
 public:
  TrialCurrents(const TrialCurrentOptions& options, double duration_s, uint64_t seed);

  Eigen::VectorXd at_A(double time_s) const;
  /// Field added to a raw reading, T.
  Vec3 field_M(double time_s) const;
  CurrentCalibration calibration() const;
  /// The sensor's readings after `after_s` up to `to_s`; `start`: stamp at second 0.
  std::vector<CurrentSample> readings(Time start, double after_s, double to_s) const;

 private:
  TrialCurrentOptions options_;
  std::vector<Vec3> fields_, calibrated_;  ///< T/A
  /// Current of each channel at the ends of spans of kSpan_s, between which it is linear, A.
  std::vector<std::vector<double>> nodes_;
};

}  // namespace lodeline
