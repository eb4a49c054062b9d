#pragma once

#include <vector>

#include "lodeline/batch/loops/loop_observation.h"
#include "lodeline/estimate.h"

namespace lodeline {

/// Correction of the states of a forward run by the poses from which the batch solution is to start. At each
/// of them the world is turned about the vertical by an angle a and shifted to the heading and position of
/// the pose. Between two of them, a and the corrected positions are interpolated over time; before the first
/// and after the last, the correction is constant. Roll and pitch stay those of the run, which gravity holds.
class InitialCorrection {
 public:
  /// `frames`: estimates of the run, in order of time. Throws InputError where the poses are not in order of
  /// time, not finite, or without a frame.
  InitialCorrection(const std::vector<FrameEstimate>& frames, const std::vector<InitialPose>& poses);

  /// Corrected pose and velocity; the biases stay. The same state where there are no poses.
  NavigationState apply(NavigationState state) const;

 private:
  struct Knot {
    Time time;
    double turn_rad = 0.0;        ///< about the vertical; continuous from knot to knot
    Vec3 shift_W = Vec3::Zero();  ///< after the turn about the world's origin

    Vec3 moved(const Vec3& position_W) const;
  };
  std::vector<Knot> knots_;
};

}  // namespace lodeline
