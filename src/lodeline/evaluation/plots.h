#pragma once

#include <filesystem>

#include "lodeline/base/diagnostics.h"
#include "lodeline/evaluation/evaluation.h"

namespace lodeline {

/// Draws top view, side view, errors over time and relative errors over distance into `folder` (made if
/// missing), each as NAME.svg and NAME.png. Drawn by gnuplot; where that program is missing or fails, a
/// warning is reported and nothing is written. Throws InputError when the folder cannot be written.
void writePlots(const Evaluation& evaluation, const std::filesystem::path& folder, Diagnostics& diagnostics);

}  // namespace lodeline
