#pragma once

#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/problem/robust_loss.h"

namespace lodeline {

/// Triangulates a track's landmark with the window's poses. The host is the first frame that observes it with
/// camera 0. The track gets no landmark where its distance is not accurate enough (LandmarkOptions).
void placeLandmark(Window& window, const FactorBuilder& factors, const LandmarkOptions& options,
                   FeatureTrack* track);

/// Optimizes a landmark with respect to its observations, then removes observations with residuals above
/// `max_error_sigmas`. Removes the landmark itself where too few observations are left or it lies behind its
/// host. Returns the number of removed observations. `errors` receives the residuals of all observations at
/// the triangulated position, in the middle of its observations. Robust losses from the smaller residuals
/// after the optimization would reduce the weight of images too much.
int removeContradictions(Window& window, const FactorBuilder& factors, const LandmarkOptions& options,
                         TrackId id, FeatureTrack* track, std::vector<ObservationError>* errors);

/// Whitened reprojection residuals of a landmark's observations, in their order.
std::vector<Vec2> residualsOf(const LandmarkFactors& landmark);

}  // namespace lodeline
