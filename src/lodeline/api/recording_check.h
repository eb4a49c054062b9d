#pragma once

#include <string>

#include "lodeline/api/run_settings.h"
#include "lodeline/diagnostics.h"
#include "lodeline/inspection/inspection.h"

namespace lodeline {

/// Checks the first seconds of the part of a recording that `options` select (checkStart), and sets the
/// offsets, units and noise found there in `options`. `data`: name of the recording for the messages.
void checkRecording(const SourceFactory& open, const std::string& data, RunSettings* options,
                    Diagnostics* diagnostics);

}  // namespace lodeline
