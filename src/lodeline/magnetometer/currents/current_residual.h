#pragma once

#include <span>

#include "lodeline/magnetometer/currents/current_fit.h"

namespace lodeline {

/// Difference of a test's readings from those without current, after a compensation that leaves `left` of the
/// fields (T/A, a row for each channel): the residual of the fit and the fields of what is left. Rows that
/// are outliers of the fit do not count.
CurrentResidual residualOf(const CurrentFit& fit, const Eigen::MatrixXd& left_T_per_A);

/// Root mean square heading of the residual's means over a second, rad: what white noise does not explain.
double slowHeading_rad(const CurrentFit& fit);

/// Median rate of readings, Hz; 0 for fewer than two.
double rateOf(std::span<const CurrentSample> samples);

}  // namespace lodeline
