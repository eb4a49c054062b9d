#pragma once

#include "lodeline/evaluation/figures/gnuplot.h"
#include "lodeline/trajectory.h"

/// Figures of an evaluation: the reference in black, the estimate in colour.
namespace lodeline {

/// Name of an alignment for titles, e.g. "SE(3)".
const char* alignmentTitle(AlignmentType type);

/// The path seen from above (x to the right, y up the page), equal axes.
gnuplot::Figure topViewFigure(const Evaluation& evaluation);

/// The path seen along the shorter of its horizontal extents, z up, equal axes.
gnuplot::Figure sideViewFigure(const Evaluation& evaluation);

/// Position error and its components, rotation and yaw error over time.
gnuplot::Figure errorOverTimeFigure(const Evaluation& evaluation);

/// Relative position and yaw error over the length of the path section, as boxes.
gnuplot::Figure relativeErrorFigure(const Evaluation& evaluation);

}  // namespace lodeline
