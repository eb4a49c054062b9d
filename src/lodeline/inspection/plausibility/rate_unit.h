#pragma once

#include <optional>

namespace lodeline {

/// Unit of a gyroscope's readings other than rad/s.
struct RateUnit {
  const char* name;
  double to_SI;
};

/// The unit for which readings turn `true_over_read` times as fast as they say in rad/s, within a factor of
/// `tolerance`. Nothing where no unit fits.
std::optional<RateUnit> rateUnitOf(double true_over_read, double tolerance);

}  // namespace lodeline
