#pragma once

#include <optional>

#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/state/window.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// The options for a rig's IMU: of one that its maker has calibrated, or whose axes are held, nothing is
/// doubted beyond what is estimated, and what is estimated of it is not counted as motion noise as well.
/// Everything below takes options that have been through this.
EstimatorOptions optionsFor(const Rig& rig, EstimatorOptions options);

/// Adds the axes of gyroscope and accelerometer (factors/inertial_factor.h), unless they are to be held.
/// Every turn then teaches what the next one needs: vision, and the magnetometer where there is one, say how
/// far the rig has really turned, and a rig that tilts turns its accelerometer in a gravity that is known.
/// FactorBuilder::imuAxes() keeps them near what is known beforehand.
void addInertialStates(Window& window, const ImuAxesOptions& options);

/// Null where the axes are held.
struct ImuAxesStates {
  explicit ImuAxesStates(const Window& window);
  ParameterBlock* gyroscope;
  ParameterBlock* accelerometer;
};
/// None where they are held.
std::optional<SensorAxes> gyroscopeAxes(const Window& window);
std::optional<SensorAxes> accelerometerAxes(const Window& window);

}  // namespace lodeline
