#pragma once

#include <vector>

#include "lodeline/evaluation/errors/evaluation.h"

namespace lodeline {

/// Root mean square errors over the poses of a run.
struct PoseRmse {
  double rotation_deg = 0.0;
  double position_m = 0.0;
};

/// The figures by which methods are compared on one recording.
struct RunErrors {
  PoseRmse sim3;       ///< after sim(3) alignment of all positions: the paper's Table I
  double scale = 1.0;  ///< of that alignment; below 1 the estimate is too large
  PoseRmse yaw;        ///< after alignment of position and yaw over all positions

  /// Against the world as it is: only the first positions coincide and, with HeadingBasis::Start, the first
  /// headings too.
  HeadingBasis basis = HeadingBasis::Start;
  double heading_rmse_deg = 0.0;
  double heading_mean_deg = 0.0;  ///< signed
  double heading_max_deg = 0.0;
  double end_point_percent = 0.0;  ///< of the path
  /// The same end point when the first headings coincide, whatever the basis.
  double end_point_equal_start_percent = 0.0;

  /// Over stretches of the path (docs/evaluation.md); independent of where north is.
  std::vector<RelativeErrors> relative;
  /// Slope of the median relative yaw error over the length of the stretch, deg per 100 m of path: near zero
  /// where heading does not drift.
  double relative_yaw_growth_deg = 0.0;

  double path_m = 0.0;  ///< of the reference, along the pairs
  double span_s = 0.0;  ///< from the first pair to the last
  Completion completion;
  /// Positions (m) from equal first positions, headings as `basis` has it; the reference's first pose is the
  /// origin.
  std::vector<Vec3> estimate_track_m;
  std::vector<Vec3> reference_track_m;

  /// Median over the longest stretches, deg; zero where the path has none.
  double relativeYaw_deg() const;
};

/// `options.alignment` is not used. Throws InputError as evaluate() does.
RunErrors computeRunErrors(const Trajectory& estimate, const Trajectory& reference, HeadingBasis basis,
                           const EvaluationOptions& options, Diagnostics& diagnostics);

}  // namespace lodeline
