#pragma once

#include <vector>

#include "lodeline/geometry/types.h"

namespace lodeline {

/// How long the errors of tracks last. A tracker follows what it saw in the image before, and a lens or a
/// port that is not quite as its file says is wrong for a point in the same way from image to image: what a
/// track is off by wanders, and its observations are no independent witnesses. Errors after a solution tell,
/// by how much neighbours resemble each other.
class TimeCorrelatedErrors {
 public:
  /// The reprojection errors of one track in one camera in order of time, in standard deviations as stated.
  void add(const std::vector<Vec2>& errors);

  /// By how much the variance of what a track tells exceeds that of so many independent observations:
  /// 1 + (n - 1) rho (L. Kish, "Survey Sampling", 1965, section 5.4), with n the number of observations in
  /// one camera, averaged over observations. rho is 0 where neighbours are no more alike than those of white
  /// noise, and 1 where they are as alike as those of a random walk; of either the landmark has taken the
  /// mean and, along its parallax, the trend. That leaves neighbours with a correlation of 1 - 5.8 / n of a
  /// random walk (to 0.05 for 6 to 40 observations; found with simulated ones) and of -1.6 / n of white
  /// noise; of two cameras, which share a landmark, with less, and -0.7 / n, at which scenes of points with
  /// white noise come out at 1, is taken for both. 1 while there is nothing to tell it by.
  double designEffect() const;

  /// Variance of an observation's error for as long as its errors last, in terms of the stated one:
  /// designEffect() times the errors' mean square along one axis. At least 1: what is stated stands for more
  /// than what errors after a solution can show.
  double variance() const;

 private:
  double observations_ = 0.0, squared_lengths_ = 0.0, squares_ = 0.0;
  // Of tracks that are long enough, weighed by their lengths: found, and expected of either kind.
  double likeness_ = 0.0, of_white_noise_ = 0.0, of_random_walk_ = 0.0;
};

}  // namespace lodeline
