#include "simulation/sensors/dvl_model.h"

#include <utility>

namespace lodeline {

DvlModel::DvlModel(const Motion& motion, const Rigid3& body_from_dvl, std::vector<Vec3> beams_D,
                   RangeFunction range, const DvlErrors& errors, uint64_t seed)
    : motion_(motion),
      body_from_dvl_(body_from_dvl),
      beams_D_(std::move(beams_D)),
      range_(std::move(range)),
      errors_(errors),
      noise_(seed, "dvl/noise"),
      losses_(seed, "dvl/losses") {}

Vec3 instrumentVelocity_D(const MotionState& state, const Rigid3& body_from_instrument) {
  const Vec3 velocity_B = state.world_from_body.rotation.conjugate() * state.velocity_W +
                          state.angular_velocity_B.cross(body_from_instrument.translation);
  return body_from_instrument.rotation.conjugate() * velocity_B;
}

DvlSample DvlModel::measure(double time_s) {
  const MotionState state = motion_.at(time_s);
  const Rigid3 world_from_dvl = state.world_from_body * body_from_dvl_;
  const Vec3 velocity_D = instrumentVelocity_D(state, body_from_dvl_);
  DvlSample ping;
  for (size_t i = 0; i < beams_D_.size(); ++i) {
    // Drawn before any decision, so that the loss of one beam does not change the noise of the next one.
    const double velocity_noise = errors_.velocity_noise_m_per_s * noise_.normal();
    const double range_noise = errors_.range_noise_m * noise_.normal();
    const bool lost = losses_.chance(errors_.dropout_share);
    const bool passes_for_valid = losses_.chance(errors_.sentinel_share);
    DvlBeam beam;
    beam.index = static_cast<int>(i);
    const auto range_m = range_(world_from_dvl.translation, world_from_dvl.rotation * beams_D_[i]);
    if (passes_for_valid) {
      beam.velocity_m_per_s = kDvlSentinel_m_per_s;
      beam.range_m = kDvlSentinelRange_m;
    } else if (!lost && range_m && *range_m >= errors_.nearest_m && *range_m <= errors_.farthest_m) {
      beam.velocity_m_per_s = (1.0 + errors_.scale) * beams_D_[i].dot(velocity_D) + velocity_noise;
      beam.range_m = (1.0 + errors_.scale) * *range_m + range_noise;
    }
    ping.beams.push_back(beam);
  }
  return ping;
}

}  // namespace lodeline
