#pragma once

#include <utility>
#include <vector>

#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/problem/covariance.h"
#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

// Not all that the estimate uses is to be claimed. Files that images confirm (IntrinsicsModelSelection) are
// held more firmly than images can confirm them, the accelerometers of some IMUs start with more of a bias
// than is good to suppose (ImuAxesOptions::areDoubted()), and how far apart cameras sit is wrong in some
// files by more than the best guess is to allow for.

/// How far off a file's baselines may be, of their length (one sigma), for all that is claimed.
constexpr double kBaselineTolerance = 0.01;

/// Of every axis of the first frame's accelerometer bias, the information that is used and not claimed,
/// (m/s^2)^-2; 0 where it is not doubted.
double removedBiasInformation(const EstimatorOptions& options);
/// Adds to a state's covariance what no state stands for: an accelerometer that warms up changes by more than
/// its bias walks, and what it takes for up is as wrong as that. Counted as large as its axes may be off.
void addDoubtAboutUp(const ImuAxesOptions& options, Eigen::Matrix<double, 15, 15>* covariance);

/// Of each state of the cameras' calibration, the information of its file that is used and not claimed: of
/// what is held (removedFileInformation()), and of where secondary cameras sit (FactorBuilder::placement()).
std::vector<std::pair<const double*, Eigen::MatrixXd>> removedCalibration(const Window& window,
                                                                          const EstimatorOptions& options,
                                                                          const FactorBuilder& factors);

/// Covariance of the newest frame's state as it is to be claimed, `known` being what the window knows.
Eigen::Matrix<double, 15, 15> reportedCovariance(const JointCovariance& known, const Window& window,
                                                 const EstimatorOptions& options,
                                                 const FactorBuilder& factors);

}  // namespace lodeline
