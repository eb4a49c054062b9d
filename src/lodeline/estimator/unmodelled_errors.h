#pragma once

#include <Eigen/Core>

#include "lodeline/estimator/options.h"
#include "lodeline/geometry/types.h"

namespace lodeline {

/// Relative sigma of one camera's scale that a lens which is not quite as its file says leaves without a
/// trace in the residuals: part of the flow by the rig's turns, which go with its accelerations, counts as
/// way. Simulated dives with calibrations off by 0.3 % behind a flat port came out 0 to 2 % too small.
constexpr double kOneCameraScaleSigma = 0.01;

/// What a frame's estimate hangs on, as far as it matters here.
struct EstimateSources {
  bool is_scale_given = false;  ///< by a second camera
  bool has_depth = false;       ///< of a pressure sensor
};

/// Of the density ratio, beyond what the covariance says; see DepthOptions::least_density_sigma.
/// Zero where the cameras' calibration is believed.
double unmodelledDensitySigma(const EstimatorOptions& options);

/// Adds to the covariance of a state (pose first, world axes) what errors of the lens that no state stands
/// for make of its position, m from the origin. They count in what is claimed, not in what is estimated.
/// Nothing where the cameras' calibration is believed.
void addUnmodelledErrors(const EstimatorOptions& options, const EstimateSources& sources,
                         const Vec3& position_W, Eigen::Matrix<double, 15, 15>* covariance);

}  // namespace lodeline
