#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "lodeline/frontend/stereo/stereo_rotation.h"

namespace lodeline {

/// Estimates by how much later than its stamp says the second camera of a pair takes its images, from the
/// distances of stereo matches to their epipolar lines. A delay d moves the second camera, between the first
/// image and its own, by the rotation w d and the translation v d (its own axes), so a match b at inverse
/// depth rho lies off its line by
///   e = -focal_px (w . (b x n) + rho n . v) d + focal_px (b x n) . theta,
/// with n the unit normal of the epipolar plane and theta a constant turn of the camera against its file. w
/// and v change from frame to frame, which tells d from theta. Minimizes the sum of |e - model| over the
/// latest matches, right and wrong ones (iteratively reweighted least squares).
class StereoDelay {
 public:
  /// The matches of one frame, as `second_from_first` places them, and the second camera's motion: angular
  /// velocity, rad/s, and velocity, m/s, in its own axes.
  void add(const std::vector<RayPair>& pairs, const Rigid3& second_from_first, double focal_px,
           const Vec3& rate_C, const Vec3& velocity_C);

  struct Estimate {
    double delay_s;
    double sigma_s;
  };
  /// Nothing before the motion has shown it.
  std::optional<Estimate> estimate() const;

  /// Forgets all matches: the delay they tell of is taken into account from now on.
  void restart() { newest_.clear(); }

 private:
  struct Equation {
    double error_px;
    Vec3 by_turn;     ///< px/rad
    double by_delay;  ///< px/s
    int frame;
  };

  std::deque<Equation> newest_;
  int frames_ = 0;
};

}  // namespace lodeline
