#pragma once

#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/problem/robust_loss.h"

namespace lodeline {

/// Gives a track a landmark where the window's poses see it, hosted by the first frame that sees it with
/// camera 0; none where its distance is not known well enough (LandmarkOptions).
void placeLandmark(Window& window, const FactorBuilder& factors, const LandmarkOptions& options,
                   FeatureTrack* track);

/// Settles a landmark among its observations, removes those that contradict it by more than
/// `max_error_sigmas`, and the landmark itself where too little is left of it or it lies behind its host.
/// Returns the number of observations removed, and adds to `errors` those of all where the landmark was
/// placed, in the middle of its observations: robust losses as wide as what is left once it has settled take
/// too much from the images.
int removeContradictions(Window& window, const FactorBuilder& factors, const LandmarkOptions& options,
                         TrackId id, FeatureTrack* track, std::vector<ObservationError>* errors);

/// Whitened reprojection errors of a landmark's observations, in their order.
std::vector<Vec2> residualsOf(const LandmarkFactors& landmark);

}  // namespace lodeline
