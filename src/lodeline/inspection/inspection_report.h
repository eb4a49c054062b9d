#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "lodeline/inspection/inspection.h"

namespace lodeline {

/// The findings, most harmful first, then a paragraph per sensor.
std::string inspectionText(const Inspection& inspection);

/// The same and further values in machine-readable form.
nlohmann::ordered_json inspectionJson(const Inspection& inspection);

}  // namespace lodeline
