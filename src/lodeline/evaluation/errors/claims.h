#pragma once

#include <cstddef>
#include <vector>

#include "lodeline/evaluation/errors/alignment.h"
#include "lodeline/evaluation/trajectory/trajectory.h"

namespace lodeline {

/// One pose with the reported sigmas of its errors.
struct ReportedPose {
  StampedPose pose;
  Vec3 position_sigma_m = Vec3::Zero();    ///< axes of the estimate's world
  Vec3 rotation_sigma_rad = Vec3::Zero();  ///< the same; z: of the heading
};

/// Poses of `lodeline run`.
struct ReportedUncertainty {
  std::vector<ReportedPose> poses;
  HeadingBasis basis = HeadingBasis::Start;  ///< reference direction of the heading's sigma
};

/// Errors of one kind compared with their standard deviations, for each axis of the estimate's world.
struct ReportedAxes {
  Vec3 within_3_sigma_percent = Vec3::Zero();  ///< of the poses; 99.7 for normal and white errors
  Vec3 rms_sigmas = Vec3::Zero();              ///< of error over sigma; 1 where the sigma is exact
};

/// Comparison of errors with their reported sigmas.
struct ConsistencyCheck {
  std::size_t poses = 0;
  HeadingBasis basis = HeadingBasis::Start;
  ReportedAxes position;
  ReportedAxes rotation;
};

/// Computes errors relative to a reference from equal first positions and, with HeadingBasis::Start, equal
/// first headings, because the sigmas of a run refer to these. The errors are rotated to the axes of the
/// estimate's world, because distances along and across the path may have very different sigmas. The first
/// pair has no error by construction and does not count. `poses` is 0 without reported sigmas or without
/// times in the reference. Throws InputError as associate() does.
ConsistencyCheck checkConsistency(const ReportedUncertainty& claims, const Trajectory& reference,
                                  const AssociationOptions& association);

}  // namespace lodeline
