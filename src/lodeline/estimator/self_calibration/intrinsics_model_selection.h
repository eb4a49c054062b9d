#pragma once

#include <utility>
#include <vector>

#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/problem/covariance.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

/// How far a right file is found to be off, of the prior's sigma, by errors of images that no covariance
/// knows of. No more than that is claimed of a file that is held.
constexpr double kFileTolerance = 0.1;

/// Logarithm of how much likelier what was seen of a calibration makes it that its file is right than that it
/// is off as its prior says: the ratio of the densities of "no deviation" after and before (Savage-Dickey;
/// Dickey, Ann. Math. Stat. 1971), both blurred by kFileTolerance. `seen` and `covariance`: of the deviations
/// from the file in units of the prior's sigmas, the prior included, which has `prior_variance` there.
double evidenceForFile(const Eigen::VectorXd& seen, const Eigen::MatrixXd& covariance, double prior_variance);

/// Decides whether lenses and the rotation of secondary cameras are as their files say.
///
/// A stereo rig measures distance by fiftieths of a pixel, and what a tracker is off by in the mean is as
/// much. Left free, lenses and rotations make up for that, by scale. But most files are either right or off
/// by far more, in several numbers that images soon tell. So they are held while evidenceForFile() is clearly
/// for it, and let go when it is not. Asked is the mean of all lenses: cameras that agree with one another
/// confirm no file, since one target or one port in front of them all makes the same error. But no single
/// number may speak against it, nor any difference between lenses. Of a baseline that is off, which is an
/// error of scale, images say nothing, but the accelerometer does: it stays free (FactorBuilder::placement).
class IntrinsicsModelSelection {
 public:
  explicit IntrinsicsModelSelection(const CameraCalibrationOptions& options) : options_(options) {}

  /// Joint covariance after the window was solved: the next solution believes in the files, or does not.
  void remember(const JointCovariance& covariance, Window& window);

 private:
  CameraCalibrationOptions options_;
  bool trusts_ = false;
};

/// Holds lenses and secondary cameras' rotations at their files (ParameterBlock::priors), or frees them;
/// nothing where the lenses are not estimated.
void believeInFiles(const Window& window, const CameraCalibrationOptions& options, bool is_believed);

/// Of each state that is so held, the information that is used and not to be claimed.
std::vector<std::pair<const double*, Eigen::MatrixXd>> removedFileInformation(
    const Window& window, const CameraCalibrationOptions& options);

}  // namespace lodeline
