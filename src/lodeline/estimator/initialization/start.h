#pragma once

#include "lodeline/factors/prior_factor.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Prior of the very first frame, around its present state. Position and heading define the world and are
/// practically fixed. The tilt has the given sigma (rad); velocity and biases have those of the options. The
/// velocity is uncertain even where the readings are constant, because they also are in a steady glide;
/// images determine it within a few frames.
Prior startPrior(Frame& first, const InitialStateOptions& options, double tilt_sigma_rad);

/// Adds the correlation of the first frame's tilt with its accelerometer bias. The tilt of `first` is that of
/// the mean specific force, and `tilt_sigma_rad` is its sigma for a given accelerometer bias. The tilt then
/// is as uncertain as the bias makes it, and information on one corrects the other. A bias b_B tilts the
/// estimate by (R b_B) x e_z / g.
void tieTiltToAccelerometerBias(const Frame& first, double gravity_m_per_s2, Prior* prior);

}  // namespace lodeline
