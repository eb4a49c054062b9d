#pragma once

#include <string>

#include "lodeline/types.h"

namespace lodeline {

/// Time since the start of a run in readable form: m:ss with one decimal (or three), with hours if necessary.
std::string clockText(double seconds, int decimals = 1);

/// Replaces every stamp in `message` on the recording's clock ("... at 1403636580013555584 ns ...") within a
/// day of `origin` by the time since then: "... at 0:16.4 ...". states.csv contains the original stamps.
std::string withReadableTimes(const std::string& message, Time origin);

}  // namespace lodeline
