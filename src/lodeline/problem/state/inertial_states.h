#pragma once

#include <optional>

#include "lodeline/problem/options/options.h"
#include "lodeline/problem/state/window.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Options adapted to a rig's IMU. If its maker calibrated it, or if its axes are held, no uncertainty is
/// added beyond the estimated states. Errors that are estimated are not counted as motion noise as well. All
/// functions below expect options that this function returned.
EstimatorOptions optionsFor(const Rig& rig, EstimatorOptions options);

/// Adds the axes of gyroscope and accelerometer (factors/inertial_factor.h), unless they are to be held.
/// Rotations make them observable: vision and any magnetometer measure the true rotation of the rig. A rig
/// that tilts rotates its accelerometer in known gravity. FactorBuilder::imuAxes() is the prior.
void addInertialStates(Window& window, const ImuAxesOptions& options);

/// States of the IMU axes; null where the axes are held.
struct ImuAxesStates {
  explicit ImuAxesStates(const Window& window);
  ParameterBlock* gyroscope;
  ParameterBlock* accelerometer;
};
/// Estimated axes; empty where they are held.
std::optional<SensorAxes> gyroscopeAxes(const Window& window);
std::optional<SensorAxes> accelerometerAxes(const Window& window);

}  // namespace lodeline
