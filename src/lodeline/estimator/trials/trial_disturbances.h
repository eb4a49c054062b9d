#pragma once

#include <cstdint>

#include "lodeline/types.h"
#include "simulation/dive/point_dive.h"
#include "simulation/sensors/magnetic_disturbance.h"

namespace lodeline {

/// Draws dipoles of iron beside a way: each turns a compass by up to 12 to 30 degrees at its place, and they
/// are about `spacing_m` apart.
std::vector<LyingDipole> drawDipolesBeside(const Motion& motion, const Vec3& field_W, double spacing_m,
                                           uint64_t seed);

/// Draws iron within 1 to 2 m of the start, which turns the compass there by 6 to 20 degrees: a mooring
/// block, a ladder. The field returns to the Earth's over some metres.
std::vector<LyingDipole> drawIronAtStart(const Motion& motion, const Vec3& field_W, uint64_t seed);

/// Draws magnetite in the walls of a passage: eight dipoles on each metre with induced and permanent moments.
/// At the diver they make a field of about 1 uT that changes over metres.
std::vector<LyingDipole> drawMagnetite(const Centerline& passage, const Vec3& field_W, uint64_t seed);

}  // namespace lodeline
