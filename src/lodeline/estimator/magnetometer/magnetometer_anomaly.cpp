// Functions of MagnetometerFusion for anomalies of the field: their size, and their map.
#include <algorithm>
#include <cmath>

#include "lodeline/estimator/magnetometer/magnetometer_fusion.h"

namespace lodeline {

void MagnetometerFusion::learnAnomaly(const FrameField& field, const FieldCheck& earth,
                                      const Window& window) {
  if (areCurrentsUncertain(field, window)) return;
  const double norm_T = MagnetometerStates(window).field_W().norm();
  const double relative_variance =
      0.5 * (earth.norm_sigma * earth.norm_sigma + earth.dip_sigma_rad * earth.dip_sigma_rad);
  const double field_sigma_T = options_.magnetometer.gate.field_sigma_T;
  const double state_variance_T2 =
      norm_T * norm_T * relative_variance - field_sigma_T * field_sigma_T - comparison_.whiteVariance();
  deviation_.add(field.mean.time, norm_T * Vec2(earth.norm_error, earth.dip_error_rad),
                 std::max(0.0, state_variance_T2), whiteVariance(field));
  const double across_T =
      MagnetometerStates(window).field_W().head<2>().norm() * std::sin(earth.heading_error_rad);
  anomaly_.add(window.newest().worldFromBody().translation,
               {deviation_.deviation_T(), deviation_.variance_T2(), across_T},
               status_ == MagnetometerStatus::Used);
}

bool MagnetometerFusion::takeByMap(const FrameField& field, const MagnetometerMean& clean, Window& window) {
  if (areCurrentsUncertain(field, window)) return false;
  const MagnetometerStates states(window);
  const double floor_T = errors_.correlated_noise_sigma_T();
  const bool is_used =
      map_.take({clean.time, clean.field_B - clean.carried * states.offset_B(), states.field_W(),
                 whiteVariance(field) + floor_T * floor_T, std::sqrt(tilt_variance_rad2_)},
                status_ != MagnetometerStatus::Readmitted, window);
  if (is_used) last_seen_ = clean.time;
  return is_used;
}

}  // namespace lodeline
