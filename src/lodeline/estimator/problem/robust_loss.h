#pragma once

#include <boost/container/flat_map.hpp>
#include <optional>
#include <vector>

#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

/// Length of an observation's whitened reprojection error, for all but those that a landmark is hosted at.
struct ObservationError {
  TrackId track = -1;
  FrameId frame = 0;
  double sigmas = 0.0;
};

/// How far the points of one frame are off, standard deviations of the stated noise.
struct FrameErrors {
  double sigma = 1.0;  ///< of one axis, by their median
  double width = 1.0;  ///< of the Cauchy loss that suits them
};

/// Of one frame's errors; nothing where they are too few to tell. Most points of a picture are found to a
/// tenth of sigma_px, which stands for what all of them have in common, as an error of the lens. Those whose
/// looks slide over the rock, shadows of the rig's lamps above all and edges before a far background, err by
/// five to ten times as much and alike; a loss as wide as sigma_px would believe them as it does the others.
///
/// The loss log(1 + r^2 / c^2) is the likelihood of errors with a bivariate t distribution of nu degrees of
/// freedom, c^2 = nu s^2, of which P(r < R) = 1 - (1 + R^2 / c^2)^(-nu / 2). Their median and 90 % quantile
/// give nu and c: 1.55 medians for nu = 4 and heavier tails, `robust_scale_medians` (2.5, what nu = 9.3 has)
/// for normal errors. (K. L. Lange, R. J. A. Little, J. M. G. Taylor, "Robust statistical modeling using the
/// t distribution", JASA 84, 1989.)
std::optional<FrameErrors> frameErrors(std::vector<double> errors_sigmas, const SolverOptions& options);

/// Squared errors of a track's observations, in terms of what is usual in their frames (FrameErrors::sigma).
struct TrackErrors {
  double sum_of_squares = 0.0;
  int count = 0;  ///< of observations, two numbers each

  /// The errors themselves give the landmark's distance.
  int degreesOfFreedom() const { return count > 0 ? 2 * count - 1 : 0; }
};

using ErrorsByTrack = boost::container::flat_map<TrackId, TrackErrors>;

/// How much tracks differ in how well they are found, 0 where by no more than chance and 1 where by far more:
/// the share of the spread of their mean squares that chance does not explain, by the median and the 90 %
/// quantile of these, made normal (Wilson and Hilferty's cube root). 0 where tracks are too few to tell.
double differenceOfTracks(const ErrorsByTrack& by_track);

/// Weight of the observations of a track. A point that slides does so in all of its observations: each of
/// them alone looks like one that is off by chance, together they tell. So every track has a variance of its
/// own. Its observations count with the square of that variance's inverse, since what slides is off by more
/// than the window can see, a landmark that fits its errors; the weight of a redescending loss (S. Geman, D.
/// E. McClure, "Statistical methods for tomographic image reconstruction", Bull. ISI 52, 1987), here of all
/// errors of a track together. The logarithm of the weight is shrunk by `difference`, so that tracks which
/// are all alike weigh alike (as in C. N. Morris, "Parametric empirical Bayes inference", JASA 78, 1983).
/// Twice the usual weight at most: that errors are small does not mean that the lens is right.
double trackWeight(const TrackErrors& errors, double difference);

/// Gives the frames the losses and the tracks the weights that their errors after a solution ask for. A frame
/// that has not been part of one keeps the widest loss: its prediction may be off by more than its points
/// will be. So has a track without errors the weight 1.
void adaptRobustLosses(Window& window, const std::vector<ObservationError>& errors,
                       const SolverOptions& options);

/// Takes all of that back, when poses are no longer right.
void resetRobustLosses(Window& window);

}  // namespace lodeline
