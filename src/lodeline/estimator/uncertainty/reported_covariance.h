#pragma once

#include <utility>
#include <vector>

#include "lodeline/problem/covariance.h"
#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

// The reported covariance leaves out some prior information that the estimate uses. The estimate holds
// calibration files that images confirm (IntrinsicsModelSelection) more firmly than images can confirm them.
// The accelerometers of some IMUs have a larger initial bias than the estimate should assume
// (ImuAxesOptions::areDoubted()). Some files state baselines with a larger error than the best estimate
// should allow for.

/// Relative error of a file's baseline length that the reported covariance allows for (one sigma).
constexpr double kBaselineTolerance = 0.01;

/// Information about each axis of the first frame's accelerometer bias that the estimate uses and the
/// reported covariance leaves out, (m/s^2)^-2. 0 where the IMU is not doubted.
double removedBiasInformation(const EstimatorOptions& options);
/// Adds the tilt error that no state represents to the covariance of a state. The output of an accelerometer
/// that warms up changes by more than its bias walk, and the estimated vertical has the same error. Its size
/// is taken from ImuAxesOptions::accelerometerSigma(), rad.
void addDoubtAboutUp(const ImuAxesOptions& options, Eigen::Matrix<double, 15, 15>* covariance);

/// Information per camera calibration state that the estimate uses and the reported covariance leaves out. It
/// consists of the information of held files (removedFileInformation()) and of the secondary cameras'
/// positions (FactorBuilder::placement()).
std::vector<std::pair<const double*, Eigen::MatrixXd>> removedCalibration(const Window& window,
                                                                          const EstimatorOptions& options,
                                                                          const FactorBuilder& factors);

/// Covariance of the newest frame's state to be reported. `known`: covariance of the window's own estimate.
Eigen::Matrix<double, 15, 15> reportedCovariance(const JointCovariance& known, const Window& window,
                                                 const EstimatorOptions& options,
                                                 const FactorBuilder& factors);

}  // namespace lodeline
