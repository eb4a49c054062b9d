#pragma once

#include <filesystem>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/figures/gnuplot.h"
#include "lodeline/trajectory.h"

namespace lodeline {

/// Draws figures into `folder` (made if missing), each as NAME.svg and NAME.png, with gnuplot; where that
/// program is missing or fails, a warning is reported and nothing is written. Throws InputError when the
/// folder cannot be written.
void drawFigures(const std::vector<gnuplot::Figure>& figures, const std::filesystem::path& folder,
                 Diagnostics& diagnostics);

/// Top view, side view, errors over time and relative errors over distance, drawn as drawFigures() does.
void writePlots(const Evaluation& evaluation, const std::filesystem::path& folder, Diagnostics& diagnostics);

}  // namespace lodeline
