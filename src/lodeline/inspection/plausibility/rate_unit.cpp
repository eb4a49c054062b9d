#include "lodeline/inspection/plausibility/rate_unit.h"

#include <array>
#include <cmath>

#include "lodeline/util/angles.h"

namespace lodeline {

std::optional<RateUnit> rateUnitOf(double true_over_read, double tolerance) {
  constexpr std::array<RateUnit, 5> kUnits = {{{"deg/s", kDegree},
                                               {"rpm", 6.0 * kDegree},
                                               {"mrad/s", 1e-3},
                                               {"mdeg/s", 1e-3 * kDegree},
                                               {"deg/h", kDegree / 3600.0}}};
  std::optional<RateUnit> nearest;
  double least = std::log(tolerance);
  for (const RateUnit& unit : kUnits) {
    const double distance = std::abs(std::log(true_over_read / unit.to_SI));
    if (!(distance < least)) continue;
    least = distance;
    nearest = unit;
  }
  return nearest;
}

}  // namespace lodeline
