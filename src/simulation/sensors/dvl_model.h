#pragma once

#include <vector>

#include "lodeline/rig.h"
#include "simulation/sensors/sonar_model.h"
#include "simulation/shared/motion.h"
#include "simulation/shared/random.h"

namespace lodeline {

/// Errors of a Doppler velocity log. Beam i with the unit vector d_i reads
///   velocity = (1 + scale) d_i . v + noise,   range = (1 + scale) r_i + noise
/// v is the velocity of the instrument over ground and r_i the distance to the surface along the beam,
/// both in the true frame D. `scale` is the error of the speed of sound.
struct DvlErrors {
  double velocity_noise_m_per_s = 0.0;
  double range_noise_m = 0.0;
  double scale = 0.0;
  double dropout_share = 0.0;   ///< fraction of beams without lock, in addition to those without an echo
  double sentinel_share = 0.0;  ///< fraction of beams whose sentinels pass for valid readings
  double nearest_m = 0.05;      ///< no lock below
  double farthest_m = 50.0;     ///< no lock beyond
};

/// What instruments deliver for a beam without lock: a velocity of exactly 0.0 and a range of -2.0.
inline constexpr double kDvlSentinel_m_per_s = 0.0;
inline constexpr double kDvlSentinelRange_m = -2.0;

/// Velocity over ground of an instrument on the body, in its frame D, m/s.
Vec3 instrumentVelocity_D(const MotionState& state, const Rigid3& body_from_instrument);

class DvlModel {
 public:
  /// `motion` must outlive the model. `body_from_dvl` is the true pose, with its misalignment.
  DvlModel(const Motion& motion, const Rigid3& body_from_dvl, std::vector<Vec3> beams_D, RangeFunction range,
           const DvlErrors& errors, uint64_t seed);

  /// The ping at `time_s` with all beams (the caller sets its time).
  DvlSample measure(double time_s);

 private:
  const Motion& motion_;
  Rigid3 body_from_dvl_;
  std::vector<Vec3> beams_D_;
  RangeFunction range_;
  DvlErrors errors_;
  Random noise_, losses_;
};

}  // namespace lodeline
