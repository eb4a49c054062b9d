#pragma once

#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Statistics of the time correlation of track errors. A tracker follows the patch of the image before.
/// Errors of the intrinsics or of a port stay with a point. The error of a track therefore wanders, and its
/// observations are not independent. The correlation of neighbouring residuals after a solution shows by how
/// much.
class TimeCorrelatedErrors {
 public:
  /// Adds the reprojection residuals of one track in one camera in order of time, in stated standard
  /// deviations.
  void add(const std::vector<Vec2>& errors);

  /// Factor by which the variance of a track's information exceeds that of independent observations: 1 + (n -
  /// 1) rho (L. Kish, "Survey Sampling", 1965, section 5.4). n is the number of observations in one camera,
  /// averaged over observations. rho is 0 where neighbours correlate no more than white noise, and 1 where
  /// they correlate like a random walk.
  ///
  /// The landmark absorbs the mean of the errors and, along its parallax, their trend. The correlation of
  /// neighbours is then 1 - 5.8 / n for a random walk (to 0.05 for 6 to 40 observations; found by simulation)
  /// and -1.6 / n for white noise. For two cameras, which share a landmark, it is smaller in size. -0.7 / n
  /// is used for both, with which scenes of points with white noise give a factor of 1. The result is 1 while
  /// there are no data.
  double designEffect() const;

  /// Variance of an observation's error within its correlation time, relative to the stated variance:
  /// designEffect() times the mean square of the residuals along one axis. At least 1, because the stated
  /// variance covers more errors than residuals after a solution can show.
  double variance() const;

 private:
  double observations_ = 0.0, squared_lengths_ = 0.0, squares_ = 0.0;
  // Sums over tracks that are long enough, weighted by length: the measured correlation, and the expected
  // ones of both kinds.
  double likeness_ = 0.0, of_white_noise_ = 0.0, of_random_walk_ = 0.0;
};

}  // namespace lodeline
