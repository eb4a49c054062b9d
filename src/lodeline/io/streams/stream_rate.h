#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/types.h"
#include "lodeline/util/time/time_unit.h"

namespace lodeline {

/// Number of stamps at the start of a stream from which its rate is measured.
inline constexpr size_t kStampsForRate = 50;

/// Measured rate, Hz: the inverse of the median step, or of the mean step where readings arrive in bursts.
/// Returns nothing where the rate is undetermined.
std::optional<double> measuredRate_hz(const std::vector<Time>& stamps);

/// The rate stated by a calibration, Hz, where it is plausible; otherwise the measured rate. A contradiction
/// between the two is reported as `rate`. `stated_hz`: 0 where nothing is stated. Returns 0 where neither
/// rate is available. `name`: of the stream, for messages. Throws InputError where many stamps are all equal
/// (`advice` gives the remedy). The same holds for stamps that are faster than a sensor by the factor between
/// two units of time.
double settleRate(const std::string& name, const std::vector<Time>& stamps, double stated_hz,
                  Diagnostics* diagnostics,
                  const std::string& advice = "use a driver that stamps its readings");

/// Throws InputError where the first stamps of a stream are no times of readings: many are all equal, or each
/// is earlier than the one before. `stamps`: in stored order; `advice`: remedy for equal stamps.
void refuseBadClock(const std::string& name, const std::vector<Time>& stamps,
                    const std::string& advice = "use a driver that stamps its readings");

/// Message about readings that are stored from the last to the first.
std::string storedInReverse(const std::string& name, Time former, Time latter);

/// Unit of integer stamps that should be nanoseconds. Another unit is returned where nanoseconds give an
/// impossible rate for the sensor and the other unit a plausible one. It is also returned for the current
/// time in steps of 100 ns (areTicks()).
TimeUnit unitOfNanosecondStamps(const std::vector<double>& stamps, PlausibleRate rate);

}  // namespace lodeline
