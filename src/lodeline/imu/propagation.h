#pragma once

#include "lodeline/geometry/rigid3.h"
#include "lodeline/imu/preintegration.h"
#include "lodeline/util/time/time.h"

namespace lodeline {

/// Navigation state at one moment.
struct NavigationState {
  Time time;
  Rigid3 world_from_body;
  Vec3 velocity_W = Vec3::Zero();            ///< m/s
  Vec3 gyroscope_bias_B = Vec3::Zero();      ///< rad/s
  Vec3 accelerometer_bias_B = Vec3::Zero();  ///< m/s^2
};

/// Predicts the state at the end of the preintegrated interval from the state at its start; the biases stay
/// constant. The interval is corrected to first order for the state's biases. Throws std::invalid_argument
/// where the time of `state` is not the start of the interval.
NavigationState predict(const NavigationState& state, const Preintegration& preintegration,
                        const Vec3& gravity_W);

}  // namespace lodeline
