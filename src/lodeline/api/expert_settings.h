#pragma once

#include "lodeline/api/run_settings.h"

namespace lodeline {

/// Binds the settings whose names begin with `expert.`: those that experiments need and users do not. Their
/// defaults serve all recordings.
void bindExpertSettings(Settings* settings, RunSettings* options);

}  // namespace lodeline
