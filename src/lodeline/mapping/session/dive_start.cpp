#include "lodeline/mapping/session/dive_start.h"

#include <cmath>

#include "lodeline/diagnostics.h"

namespace lodeline {

void DiveStart::check() const {
  const auto is_sigma = [](double value) { return std::isfinite(value) && value > 0.0; };
  if (!position.allFinite() || !is_sigma(horizontal_sigma_m) || !is_sigma(vertical_sigma_m))
    throw UsageError("the start of a dive wants three finite numbers, and its sigmas two positive ones");
}

}  // namespace lodeline
