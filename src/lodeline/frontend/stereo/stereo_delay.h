#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "lodeline/frontend/stereo/stereo_rotation.h"

namespace lodeline {

/// Estimates the delay of a pair's second camera relative to its time stamps from the distances of stereo
/// matches to their epipolar lines. A delay d moves the second camera between the images by the rotation w d
/// and the translation v d (its own axes). A match b at inverse depth rho is then off its line by
///   e = -focal_px (w . (b x n) + rho n . v) d + focal_px (b x n) . theta,
/// with n the unit normal of the epipolar plane and theta a constant rotation of the camera relative to its
/// file. w and v change from frame to frame, which separates d from theta. The estimate minimizes the sum of
/// |e - model| over the latest matches, correct and wrong ones (iteratively reweighted least squares).
class StereoDelay {
 public:
  /// Adds the matches of one frame with the extrinsics `second_from_first`, and the second camera's motion:
  /// angular velocity, rad/s, and velocity, m/s, in its own axes.
  void add(const std::vector<RayPair>& pairs, const Rigid3& second_from_first, double focal_px,
           const Vec3& rate_C, const Vec3& velocity_C);

  struct Estimate {
    double delay_s;
    double sigma_s;
  };
  /// Empty until the motion makes the delay observable.
  std::optional<Estimate> estimate() const;

  /// Discards all matches, because the estimated delay is compensated from now on.
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
