#pragma once

#include <optional>

#include "lodeline/estimator/options.h"
#include "lodeline/estimator/window.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// Adds the axes of a gyroscope with this noise (factors/inertial_factor.h), unless they are to be believed.
/// Every turn then teaches what the next one needs: vision, and the magnetometer where there is one, say how
/// far the rig has really turned. FactorMaker::gyroscopeAxes() holds them to what is known beforehand.
void addInertialStates(Window& window, const ImuNoise& noise, const ImuAxesOptions& options);

/// Null where the axes are taken as calibrated.
GlobalState* gyroscopeAxesState(const Window& window);
std::optional<GyroscopeAxes> gyroscopeAxes(const Window& window);

}  // namespace lodeline
