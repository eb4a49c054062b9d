#pragma once

#include "lodeline/estimator/options.h"
#include "lodeline/estimator/window.h"
#include "lodeline/factors/prior_factor.h"

namespace lodeline {

/// The prior that the very first frame starts from, around its present state: position and heading define the
/// world and are all but fixed, tilt has the given sigma (rad), velocity and biases those of the options.
Prior startPrior(Frame& first, const InitialStateOptions& options, double tilt_sigma_rad, bool still);

}  // namespace lodeline
