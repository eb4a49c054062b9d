#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "lodeline/base/diagnostics.h"

namespace lodeline {

/// One line a finding, worst first.
std::string findingsText(const Diagnostics& diagnostics);

/// The same for programs: severity, kind, message, count.
nlohmann::ordered_json findingsJson(const Diagnostics& diagnostics);

}  // namespace lodeline
