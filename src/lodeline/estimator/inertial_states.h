#pragma once

#include <optional>

#include "lodeline/estimator/covariance.h"
#include "lodeline/estimator/options.h"
#include "lodeline/estimator/window.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// The options for a rig's IMU: of one that its maker has calibrated, or whose axes are held, nothing is
/// doubted beyond what is estimated. Everything below takes options that have been through this.
EstimatorOptions optionsFor(const Rig& rig, EstimatorOptions options);

/// Adds the axes of the gyroscope (factors/inertial_factor.h), unless they are to be held. Every turn then
/// teaches what the next one needs: vision, and the magnetometer where there is one, say how far the rig has
/// really turned. FactorMaker::gyroscopeAxes() keeps them near what is known beforehand.
void addInertialStates(Window& window, const ImuAxesOptions& options);

/// Null where the axes are held.
GlobalState* gyroscopeAxesState(const Window& window);
std::optional<GyroscopeAxes> gyroscopeAxes(const Window& window);

/// Of some IMUs nobody knows whether their maker has calibrated them (ImuAxesOptions::areDoubted()). The
/// estimate takes them for calibrated until the dive tells otherwise, and would claim as much of its
/// beginning. What is claimed is less:
///
/// Information of the gyroscope's axes (9 x 9, positive semidefinite) that is used and not claimed; none
/// where they are not doubted.
std::optional<Eigen::MatrixXd> unclaimedInformation(const Window& window, const FactorMaker& factors,
                                                    const ImuAxesOptions& options);
/// The same of every axis of the first frame's accelerometer bias, (m/s^2)^-2; 0 where it is not doubted.
double unclaimedBiasInformation(const EstimatorOptions& options);
/// Adds to a state's covariance what no state stands for, the accelerometer's axes: what it takes for up is
/// as wrong as they are.
void addDoubtAboutUp(const ImuAxesOptions& options, Eigen::Matrix<double, 15, 15>* covariance);

/// Covariance of the newest frame's state as it is to be claimed, `known` being what the window knows.
Eigen::Matrix<double, 15, 15> claimedCovariance(const JointCovariance& known, const Window& window,
                                                const FactorMaker& factors, const EstimatorOptions& options);

}  // namespace lodeline
