#pragma once

#include <vector>

#include "simulation/motion/posed_motion.h"
#include "simulation/sensors/magnetic_disturbance.h"

namespace lodeline {

/// Draws the magnetization of a steel hull. Dipoles stand on its plates every 2 m; each has an induced moment
/// along the Earth's field and a permanent one. A magnetized deck plate of 8 x 6 m above the stern is a grid
/// of equal dipoles every 0.5 m. The field is several microtesla beside the hull and below 1 uT at 15 m
/// from it.
std::vector<LyingDipole> drawHullSteel(const WreckLayout& wreck, const Vec3& field_W, uint64_t seed);

}  // namespace lodeline
