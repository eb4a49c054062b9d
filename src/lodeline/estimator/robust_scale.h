#pragma once

#include <map>
#include <optional>
#include <vector>

#include "lodeline/estimator/options.h"
#include "lodeline/estimator/window.h"

namespace lodeline {

/// Lengths of the whitened reprojection errors of frames' sightings (standard deviations), but for those that
/// a landmark is hosted at.
using FrameErrors = std::map<FrameId, std::vector<double>>;

/// Width c of the Cauchy loss (standard deviations) for one frame's errors; nothing where they are too few to
/// tell. Most points of a picture are found to a tenth of sigma_px, which stands for what all of them have in
/// common, as an error of the lens. Those whose looks slide over the rock, shadows of the rig's lamps above
/// all and edges before a far background, err by five to ten times as much and alike; a loss as wide as
/// sigma_px would believe them as it does the others.
///
/// The loss log(1 + r^2 / c^2) is the likelihood of errors with a bivariate t distribution of nu degrees of
/// freedom, c^2 = nu s^2, of which P(r < R) = 1 - (1 + R^2 / c^2)^(-nu / 2). Their median and 90 % quantile
/// give nu and c: 1.55 medians for nu = 4 and heavier tails, `robust_scale_medians` (2.5, what nu = 9.3 has)
/// for normal errors. (K. L. Lange, R. J. A. Little, J. M. G. Taylor, "Robust statistical modeling using the
/// t distribution", JASA 84, 1989.)
std::optional<double> robustScale(std::vector<double> errors_sigmas, const SolverOptions& options);

/// Gives the frames the widths that their errors after a solution ask for. A frame that has not been part of
/// one keeps the widest loss: its prediction may be off by more than its points will be.
void adaptRobustScales(Window& window, FrameErrors errors_sigmas, const SolverOptions& options);

}  // namespace lodeline
