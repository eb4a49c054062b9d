#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "lodeline/diagnostics.h"
#include "lodeline/trajectory.h"

namespace lodeline {

/// The results as a table for people, lengths in metres, angles in degrees.
std::string evaluationTable(const Evaluation& evaluation);

/// All results in JSON; every key contains its unit.
nlohmann::ordered_json evaluationJson(const Evaluation& evaluation, const Diagnostics& diagnostics);

}  // namespace lodeline
