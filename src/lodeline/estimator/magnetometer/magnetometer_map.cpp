// The function of MagnetometerFusion that offers readings to the map of the field.
#include <cmath>

#include "lodeline/estimator/magnetometer/magnetometer_fusion.h"

namespace lodeline {

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
