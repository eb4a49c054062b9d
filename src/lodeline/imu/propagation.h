#pragma once

#include "lodeline/estimate.h"
#include "lodeline/imu/preintegration.h"
#include "lodeline/types.h"

namespace lodeline {

/// Predicts the state at the end of the preintegrated interval from the state at its start; the biases stay
/// constant. The interval is corrected to first order for the state's biases. Throws std::invalid_argument
/// where the time of `state` is not the start of the interval.
NavigationState predict(const NavigationState& state, const Preintegration& preintegration,
                        const Vec3& gravity_W);

}  // namespace lodeline
