#include "lodeline/imu/propagation.h"

#include <fmt/format.h>

#include <stdexcept>

namespace lodeline {

NavigationState predict(const NavigationState& state, const Preintegration& preintegration,
                        const Vec3& gravity_W) {
  if (state.time != preintegration.start()) {
    throw std::invalid_argument(fmt::format("state of {} ns, but the preintegrated interval starts at {} ns",
                                            state.time.nanoseconds(), preintegration.start().nanoseconds()));
  }
  const RelativeMotion motion =
      preintegration.correctedFor(state.gyroscope_bias_B, state.accelerometer_bias_B);
  const double dt = preintegration.dt_s();
  const Quat& world_from_body_k = state.world_from_body.rotation;

  NavigationState next = state;
  next.time = preintegration.end();
  next.world_from_body.translation +=
      dt * state.velocity_W + 0.5 * dt * dt * gravity_W + world_from_body_k * motion.alpha;
  next.world_from_body.rotation = (world_from_body_k * motion.gamma).normalized();
  next.velocity_W += dt * gravity_W + world_from_body_k * motion.beta;
  return next;
}

}  // namespace lodeline
