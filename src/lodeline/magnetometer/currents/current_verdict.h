#pragma once

#include <string>

#include "lodeline/magnetometer/currents/current_fit.h"

namespace lodeline {

/// The worth of a fit in words, as the verdicts of magnetometer calibrations: Good below 0.5 degrees of
/// expected heading error, Usable below 2, else Weak. A channel without a field makes it Usable at best.
std::string verdictOf(const CurrentFit& fit);

}  // namespace lodeline
