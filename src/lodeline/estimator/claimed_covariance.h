#pragma once

#include <utility>
#include <vector>

#include "lodeline/estimator/covariance.h"
#include "lodeline/estimator/options.h"
#include "lodeline/estimator/window.h"

namespace lodeline {

// Not all that the estimate uses is to be claimed. Of some IMUs nobody knows whether their maker has
// calibrated them (ImuAxesOptions::areDoubted()); they are taken for calibrated until the dive tells
// otherwise. Files that images confirm (LensTrust) are held more firmly than images can confirm them.

/// Of global states: the information (positive semidefinite) that is used and not claimed.
std::vector<std::pair<const double*, Eigen::MatrixXd>> unclaimedInformation(const Window& window,
                                                                            const FactorMaker& factors,
                                                                            const EstimatorOptions& options);
/// The same of every axis of the first frame's accelerometer bias, (m/s^2)^-2; 0 where it is not doubted.
double unclaimedBiasInformation(const EstimatorOptions& options);
/// Adds to a state's covariance what no state stands for, the accelerometer's axes: what it takes for up is
/// as wrong as they are.
void addDoubtAboutUp(const ImuAxesOptions& options, Eigen::Matrix<double, 15, 15>* covariance);

/// Covariance of the newest frame's state as it is to be claimed, `known` being what the window knows.
Eigen::Matrix<double, 15, 15> claimedCovariance(const JointCovariance& known, const Window& window,
                                                const FactorMaker& factors, const EstimatorOptions& options);

}  // namespace lodeline
