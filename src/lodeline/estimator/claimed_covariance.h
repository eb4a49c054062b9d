#pragma once

#include "lodeline/estimator/covariance.h"
#include "lodeline/estimator/options.h"
#include "lodeline/estimator/window.h"

namespace lodeline {

// Not all that the estimate uses is to be claimed. Files that images confirm (LensTrust) are held more firmly
// than images can confirm them, and the accelerometers of some IMUs start with more of a bias than is good to
// suppose (ImuAxesOptions::areDoubted()).

/// Of every axis of the first frame's accelerometer bias, the information that is used and not claimed,
/// (m/s^2)^-2; 0 where it is not doubted.
double unclaimedBiasInformation(const EstimatorOptions& options);
/// Adds to a state's covariance what no state stands for: an accelerometer that warms up changes by more than
/// its bias walks, and what it takes for up is as wrong as that. Counted as large as its axes may be off.
void addDoubtAboutUp(const ImuAxesOptions& options, Eigen::Matrix<double, 15, 15>* covariance);

/// Covariance of the newest frame's state as it is to be claimed, `known` being what the window knows.
Eigen::Matrix<double, 15, 15> claimedCovariance(const JointCovariance& known, const Window& window,
                                                const EstimatorOptions& options);

}  // namespace lodeline
