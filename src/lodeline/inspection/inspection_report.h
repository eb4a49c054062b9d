#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "lodeline/inspection/inspection.h"

namespace lodeline {

/// What was found, most harmful first, then a paragraph a sensor.
std::string inspectionText(const Inspection& inspection);

/// The same and more for programs.
nlohmann::ordered_json inspectionJson(const Inspection& inspection);

}  // namespace lodeline
