#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "lodeline/diagnostics.h"

namespace lodeline {

/// One line per finding, most severe first.
std::string findingsText(const Diagnostics& diagnostics);

/// The findings in JSON: severity, kind, message, count. `readable` converts each message, unless it is null.
nlohmann::ordered_json findingsJson(const Diagnostics& diagnostics,
                                    const std::function<std::string(const std::string&)>& readable = nullptr);

}  // namespace lodeline
