#pragma once

#include <cstddef>
#include <vector>

#include "lodeline/evaluation/errors/alignment.h"
#include "lodeline/evaluation/trajectory/trajectory.h"

namespace lodeline {

/// One pose with what the run that estimated it says of its errors.
struct ReportedPose {
  StampedPose pose;
  Vec3 position_sigma_m = Vec3::Zero();    ///< axes of the estimate's world
  Vec3 rotation_sigma_rad = Vec3::Zero();  ///< the same; z: of the heading
};

/// The poses of `lodeline run`.
struct ReportedUncertainty {
  std::vector<ReportedPose> poses;
  HeadingBasis basis = HeadingBasis::Start;  ///< what the heading's sigma is measured from
};

/// Errors of one kind beside their standard deviations, each axis of the estimate's world for itself.
struct ReportedAxes {
  Vec3 within_3_sigma_percent = Vec3::Zero();  ///< of the poses; 99.7 where errors are normal and white
  Vec3 rms_sigmas = Vec3::Zero();              ///< of error over sigma; 1 where the claim is exact
};

/// Whether errors are as large as claimed.
struct ConsistencyCheck {
  std::size_t poses = 0;
  HeadingBasis basis = HeadingBasis::Start;
  ReportedAxes position;
  ReportedAxes rotation;
};

/// Errors against a reference from equal first positions and, with HeadingBasis::Start, first headings: what
/// sigmas of a run are about. They are turned to the axes of the estimate's world, where a way's length and
/// its direction may be known very differently. The first pair, which has no error then, does not count.
/// Nothing to judge (`poses` is 0) without claims or without times in the reference; throws InputError as
/// associate() does.
ConsistencyCheck checkConsistency(const ReportedUncertainty& claims, const Trajectory& reference,
                                  const AssociationOptions& association);

}  // namespace lodeline
