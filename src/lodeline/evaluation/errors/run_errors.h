#pragma once

#include <vector>

#include "lodeline/trajectory.h"

namespace lodeline {

/// Root mean square errors over the poses of a run.
struct PoseRmse {
  double rotation_deg = 0.0;
  double position_m = 0.0;
};

/// Error measures for the comparison of methods on one recording.
struct RunErrors {
  PoseRmse sim3;       ///< after Sim(3) alignment of all positions: Table I of the paper
  double scale = 1.0;  ///< of that alignment; below 1 where the estimate is too large
  PoseRmse yaw;        ///< after alignment of position and yaw over all positions

  /// Errors relative to the world itself: only the first positions and, with HeadingBasis::Start, the first
  /// headings are made equal.
  HeadingBasis basis = HeadingBasis::Start;
  double heading_rmse_deg = 0.0;
  double heading_mean_deg = 0.0;  ///< signed
  double heading_max_deg = 0.0;
  double end_point_percent = 0.0;  ///< of the path
  /// End point error with equal first headings, whatever the basis.
  double end_point_equal_start_percent = 0.0;

  /// Over sections of the path (docs/reference/error-measures.md); independent of north.
  std::vector<RelativeErrors> relative;
  /// Slope of the median relative yaw error over the length of the section, deg per 100 m of path: near zero
  /// where heading does not drift.
  double relative_yaw_growth_deg = 0.0;

  double path_m = 0.0;  ///< of the reference, along the pairs
  double span_s = 0.0;  ///< from the first pair to the last
  Completion completion;
  /// Positions (m) from equal first positions, headings according to `basis`; the origin is the reference's
  /// first pose.
  std::vector<Vec3> estimate_track_m;
  std::vector<Vec3> reference_track_m;

  /// Median over the longest sections, deg; zero where the path has none.
  double relativeYaw_deg() const;
};

/// `options.alignment` is not used. Throws InputError as evaluate() does.
RunErrors computeRunErrors(const Trajectory& estimate, const Trajectory& reference, HeadingBasis basis,
                           const EvaluationOptions& options, Diagnostics& diagnostics);

}  // namespace lodeline
