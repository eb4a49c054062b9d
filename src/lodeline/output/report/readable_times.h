#pragma once

#include <string>

#include "lodeline/util/time/time.h"

namespace lodeline {

/// Time since the start of a run as people read it: m:ss and one decimal (or three), with hours where there
/// are some.
std::string clockText(double seconds, int decimals = 1);

/// `message` with every stamp on the recording's clock ("... at 1403636580013555584 ns ...") that lies within
/// a day of `origin` as the time since then: "... at 0:16.4 ...". Programs find the stamps in states.csv.
std::string withReadableTimes(const std::string& message, Time origin);

}  // namespace lodeline
