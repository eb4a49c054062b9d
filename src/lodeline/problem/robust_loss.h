#pragma once

#include <boost/container/flat_map.hpp>
#include <optional>
#include <vector>

#include "lodeline/problem/options/options.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Norm of an observation's whitened reprojection residual, for all observations except those that define a
/// landmark's host ray.
struct ObservationError {
  TrackId track = -1;
  FrameId frame = 0;
  double sigmas = 0.0;
};

/// Spread of the residuals of one frame, in standard deviations of the stated noise.
struct FrameErrors {
  double sigma = 1.0;  ///< of one axis, from their median
  double width = 1.0;  ///< of the Cauchy loss that fits them
};

/// Spread of one frame's residuals; empty where they are too few. Most points of an image are found with an
/// accuracy of a tenth of sigma_px. sigma_px covers the errors that all points have in common, such as errors
/// of the intrinsics. Some points slide over the rock with the image content, mainly shadows of the rig's
/// lamps and edges in front of a distant background. Their errors are five to ten times as large and
/// correlated; a loss as wide as sigma_px would weight them like the others.
///
/// The loss log(1 + r^2 / c^2) is the negative log-likelihood of errors with a bivariate t distribution of nu
/// degrees of freedom, c^2 = nu s^2. For it P(r < R) = 1 - (1 + R^2 / c^2)^(-nu / 2). The median and the 90 %
/// quantile of the errors give nu and c: 1.55 medians for nu = 4 and heavier tails, `robust_scale_medians`
/// (2.5, the value for nu = 9.3) for normal errors. (K. L. Lange, R. J. A. Little, J. M. G. Taylor, "Robust
/// statistical modeling using the t distribution", JASA 84, 1989.)
std::optional<FrameErrors> frameErrors(std::vector<double> errors_sigmas, const SolverOptions& options);

/// Squared residuals of a track's observations, in units of the usual residual in their frames
/// (FrameErrors::sigma).
struct TrackErrors {
  double sum_of_squares = 0.0;
  int count = 0;  ///< of observations, with two residuals each

  /// One degree of freedom less, because the residuals also determine the landmark's distance.
  int degreesOfFreedom() const { return count > 0 ? 2 * count - 1 : 0; }
};

using ErrorsByTrack = boost::container::flat_map<TrackId, TrackErrors>;

/// Difference of the accuracy of tracks: 0 where chance explains it, 1 where it is far larger. It is the
/// share of the spread of the tracks' mean squares that chance does not explain. The spread comes from their
/// median and 90 % quantile after Wilson and Hilferty's cube root, which makes them normal. 0 where tracks
/// are too few.
double differenceOfTracks(const ErrorsByTrack& by_track);

/// Weight of the observations of a track. A point that slides does so in all of its observations: each one
/// alone looks like a random error, but together they are significant. Every track therefore has its own
/// variance. The weight of its observations is the inverse square of that variance: the landmark fits its
/// residuals, so a sliding point is off by more than they show. This is the weight of a redescending loss (S.
/// Geman, D. E. McClure, "Statistical methods for tomographic image reconstruction", Bull. ISI 52, 1987),
/// here of all residuals of a track together. The logarithm of the weight is shrunk by `difference`, so that
/// tracks of equal accuracy get equal weights (as in C. N. Morris, "Parametric empirical Bayes inference",
/// JASA 78, 1983). The weight is at most 2, because small residuals do not prove that the intrinsics are
/// right.
double trackWeight(const TrackErrors& errors, double difference);

/// Sets the losses of frames and the weights of tracks from their residuals after a solution. A frame before
/// its first solution keeps the widest loss, because its prediction may be off by more than its points. A
/// track without residuals has the weight 1.
void adaptRobustLosses(Window& window, const std::vector<ObservationError>& errors,
                       const SolverOptions& options);

/// Resets all losses and weights, when the poses are no longer valid.
void resetRobustLosses(Window& window);

}  // namespace lodeline
