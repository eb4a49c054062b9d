#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/errors/comparison.h"
#include "lodeline/evaluation/figures/gnuplot.h"

/// Output of a comparison: text and Markdown for people, JSON for programs, figures.
namespace lodeline {

/// One row per method with the means over its runs; below, remarks on runs that failed or have no pose for
/// some images.
std::string comparisonTable(const ComparedRecording& recording);

/// The same as a Markdown table, with errors relative to those of baselineOf().
std::string comparisonMarkdown(const ComparedRecording& recording);

/// Every run and the means; keys contain units.
nlohmann::ordered_json comparisonJson(const ComparedRecording& recording);

/// Top view of the reference and every method's first run with errors, from equal first positions (and
/// headings without north); NAME_trajectories.
gnuplot::Figure trajectoriesFigure(const ComparedRecording& recording);

/// Relative yaw error over the length of the path section, one box per method and length over all runs:
/// median, quartiles, 5 and 95 %; NAME_relative_yaw.
gnuplot::Figure relativeYawFigure(const ComparedRecording& recording);

}  // namespace lodeline
