#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "lodeline/evaluation/errors/comparison.h"
#include "lodeline/evaluation/figures/gnuplot.h"
#include "lodeline/util/diagnostics.h"

/// A comparison for people (text, Markdown), for programs (JSON) and in pictures.
namespace lodeline {

/// One row a method with the means over its runs; below it, what became of runs that failed or did not get a
/// pose for every image.
std::string comparisonTable(const ComparedRecording& recording);

/// The same as a table of Markdown, with errors relative to those of baselineOf().
std::string comparisonMarkdown(const ComparedRecording& recording);

/// Every run and the means; keys carry units.
nlohmann::ordered_json comparisonJson(const ComparedRecording& recording);

/// Paths of every method's first run with errors from above, from equal first positions (and headings, where
/// a method knows no north), with the reference; NAME_trajectories.
gnuplot::Figure trajectoriesFigure(const ComparedRecording& recording);

/// Relative yaw error over the length of the stretch, one box a method and length over all runs: median,
/// quartiles, 5 and 95 %; NAME_relative_yaw.
gnuplot::Figure relativeYawFigure(const ComparedRecording& recording);

}  // namespace lodeline
