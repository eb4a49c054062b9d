#pragma once

#include <utility>
#include <vector>

#include "lodeline/problem/covariance.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Apparent deviation from a correct file, in the prior's sigmas, that image errors outside every covariance
/// cause. The reported information on a held file is not larger than this.
constexpr double kFileTolerance = 0.1;

/// Logarithm of the Bayes factor for a correct file against one with errors as in its prior. It is the ratio
/// of the densities of "no deviation" after and before (Savage-Dickey; Dickey, Ann. Math. Stat. 1971), both
/// blurred by kFileTolerance. `seen` and `covariance`: deviations from the file in units of the prior's
/// sigmas, with the prior included, whose variance in these units is `prior_variance`.
double evidenceForFile(const Eigen::VectorXd& seen, const Eigen::MatrixXd& covariance, double prior_variance);

/// Decides whether the intrinsics and the rotations of secondary cameras are as in their files.
///
/// A stereo rig measures distance by fiftieths of a pixel, and the mean error of a tracker is just as large.
/// If they are free, intrinsics and rotations absorb that error and bias the scale. Most files, however, are
/// either correct or wrong by far more, in several parameters that images soon reveal. The parameters are
/// therefore held while evidenceForFile() is clearly for the file, and freed when it is not. The test uses
/// the mean intrinsics of all cameras. Cameras that agree with each other confirm no file: one calibration
/// target or one port causes the same error in each. In addition, no single parameter and no difference
/// between the intrinsics of two cameras may contradict the file. A wrong baseline is an error of scale,
/// which images do not reveal but the accelerometer does: it stays free (FactorBuilder::placement).
class IntrinsicsModelSelection {
 public:
  explicit IntrinsicsModelSelection(const CameraCalibrationOptions& options) : options_(options) {}

  /// Updates the decision for the next solution with the joint covariance of the solved window.
  void remember(const JointCovariance& covariance, Window& window);

 private:
  CameraCalibrationOptions options_;
  bool trusts_ = false;
};

/// Holds the intrinsics and the secondary cameras' rotations at their files (ParameterBlock::priors), or
/// frees them; no effect where the intrinsics are not estimated.
void believeInFiles(const Window& window, const CameraCalibrationOptions& options, bool is_believed);

/// Information per held state that the estimate uses and the reported covariance leaves out.
std::vector<std::pair<const double*, Eigen::MatrixXd>> removedFileInformation(
    const Window& window, const CameraCalibrationOptions& options);

}  // namespace lodeline
