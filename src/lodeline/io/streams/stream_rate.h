#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/util/diagnostics.h"
#include "lodeline/util/time/time.h"
#include "lodeline/util/time/time_unit.h"

namespace lodeline {

/// Stamps from the start of a stream that its rate is measured on.
inline constexpr size_t kStampsForRate = 50;

/// The inverse of the median step; of the mean step where readings come in bursts. Nothing where there is no
/// rate.
std::optional<double> measuredRate_hz(const std::vector<Time>& stamps);

/// The rate that a calibration states, in Hz, where that is plausible; else the measured one, which is
/// reported as `rate` where the two contradict each other. `stated_hz`: 0 where nothing is stated. Returns 0
/// where neither can be had. `name`: of the stream, for messages. Throws InputError where all of many stamps
/// are the same; `advice` tells what can be done about that.
double settleRate(const std::string& name, const std::vector<Time>& stamps, double stated_hz,
                  Diagnostics* diagnostics,
                  const std::string& advice = "use a driver that stamps its readings");

/// The unit of integer stamps that should be nanoseconds: another one only where the sensor cannot measure as
/// often as nanoseconds say, and where the other unit gives it a rate that it can have.
TimeUnit unitOfNanosecondStamps(const std::vector<double>& stamps, PlausibleRate rate);

}  // namespace lodeline
