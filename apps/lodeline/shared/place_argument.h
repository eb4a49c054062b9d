#pragma once

#include <string>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/grid/place_text.h"

namespace lodeline {

/// Position from the command line or a project, in the notations of parsePlace(). Reports a missing height,
/// which is then 0. `option` is for messages. Throws UsageError for anything else.
GeodeticPosition placeFromText(const std::string& text, const std::string& option, Diagnostics* diagnostics);

}  // namespace lodeline
