#pragma once

#include <optional>
#include <vector>

#include "lodeline/estimator/belief.h"
#include "lodeline/estimator/covariance.h"
#include "lodeline/estimator/options.h"
#include "lodeline/estimator/window.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// Logarithm of the odds that a file states a baseline right, to `stated_sigma_m`, when by all but the file
/// it was seen to be longer by `seen`, m. Nine files in ten are right; the others were made with a target
/// whose length was typed in wrong, or with a ruler, and are off by anything up to a tenth of the baseline.
double oddsForBaseline(const Belief& seen, double stated_sigma_m, double baseline_m);

/// What the window is to believe of where further cameras sit (GlobalState::beliefs of their placements).
///
/// Images fit a file that is wrong in nothing but its lengths, and every distance is wrong by as much. The
/// accelerometer tells, to a percent within a minute or so; until then a right file is by far the better
/// ruler, and a wrong one has to go as soon as that is clear. So after every solution it is asked what the
/// window says without its belief, and the file is believed until that makes it a hundred times likelier to
/// be wrong. A robust loss in place of this asks where the estimate is, which a firm belief keeps from
/// moving: wide enough to let go of centimetres, it gave way to one sigma of the accelerometer's noise.
class BaselineBelief {
 public:
  BaselineBelief(const Rig& rig, const EstimatorOptions& options);

  /// Joint covariance after the window was solved: sets what the next solution believes.
  void remember(const JointCovariance& covariance, Window& window);
  /// Whether a baseline may still be far from where it will come to lie, having been believed until lately.
  bool isMoving() const;

 private:
  struct Baseline {
    Vec3 direction_C0;
    double length_m = 0.0;
    bool is_believed = true;
    int solutions_since = 0;  ///< it was believed
  };
  /// How much longer the window says it is, without its belief; nothing while it says nothing.
  static std::optional<Belief> seen(const GlobalState& further, const Baseline& baseline,
                                    const JointCovariance& covariance);

  CameraCalibrationOptions options_;
  double accelerometer_sigma_;       ///< relative, of the scale: what no covariance knows of
  std::vector<Baseline> baselines_;  ///< of camera 1, 2, ... by their files
};

}  // namespace lodeline
