#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// One line a finding, worst first.
std::string findingsText(const Diagnostics& diagnostics);

/// The same for programs: severity, kind, message, count. `readable`: changes each message, where it is
/// given.
nlohmann::ordered_json findingsJson(const Diagnostics& diagnostics,
                                    const std::function<std::string(const std::string&)>& readable = nullptr);

}  // namespace lodeline
