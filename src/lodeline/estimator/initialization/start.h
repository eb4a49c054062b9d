#pragma once

#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/state/window.h"
#include "lodeline/factors/prior_factor.h"

namespace lodeline {

/// The prior that the very first frame starts from, around its present state: position and heading define the
/// world and are all but fixed, tilt has the given sigma (rad), velocity and biases those of the options. The
/// velocity is open even where the readings are still, since those of a steady glide are as well: images tell
/// it within a few frames.
Prior startPrior(Frame& first, const InitialStateOptions& options, double tilt_sigma_rad);

/// Where the tilt of `first` is that of the mean specific force, and `tilt_sigma_rad` what it is known to
/// given the accelerometer's bias: ties the two, so that the tilt is as uncertain as the bias says and what
/// is learned of one rights the other. A bias b_B tilts the estimate by (R b_B) x e_z / g.
void tieTiltToAccelerometerBias(const Frame& first, double gravity_m_per_s2, Prior* prior);

}  // namespace lodeline
