#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/base/diagnostics.h"
#include "lodeline/base/time.h"

namespace lodeline {

/// Stamps from the start of a stream that its rate is measured on.
inline constexpr size_t kStampsForRate = 50;

/// The inverse of the median step; nothing where that is no rate.
std::optional<double> measuredRate_hz(const std::vector<Time>& stamps);

/// The rate that a calibration states, in Hz, where that is plausible; else the measured one, which is
/// reported as `rate` where the two contradict each other. `stated_hz`: 0 where nothing is stated. Returns 0
/// where neither can be had. `name`: of the stream, for messages.
double settleRate(const std::string& name, const std::vector<Time>& stamps, double stated_hz,
                  Diagnostics* diagnostics);

}  // namespace lodeline
