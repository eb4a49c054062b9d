#pragma once

#include <string>
#include <vector>

#include "lodeline/evaluation/errors/association.h"
#include "lodeline/geometry/rigid3.h"

namespace lodeline {

/// Type of the transformation from the world of the estimate to that of the reference before errors are
/// computed. It should contain the unobservable directions of the estimator: visual-inertial odometry does
/// not know position and yaw (Yaw), a single camera alone does not know the scale either (Sim3).
enum class AlignmentType { None, Yaw, SE3, Sim3 };

/// "none", "yaw", "se3", "sim3" and back; UsageError for another name.
const char* toString(AlignmentType type);
AlignmentType alignmentTypeFromString(const std::string& name);

/// p_reference = scale * R * p_estimate + t.
struct Alignment {
  double scale = 1.0;
  Rigid3 reference_from_estimate;  ///< R and t (m); t is applied after the scale

  /// Whether the rotation comes from the orientations, because the positions do not determine it (fewer than
  /// three, all at one position or on one line; for Yaw: no horizontal extent).
  bool rotation_from_orientations = false;

  Rigid3 apply(const Rigid3& estimate_world_from_body) const;

  /// Relative scale error of the estimate, positive where it is too large: 1/scale - 1.
  double scaleError() const { return 1.0 / scale - 1.0; }
};

/// The least-squares alignment of the positions. SE3 and Sim3: Umeyama, "Least-squares estimation of
/// transformation parameters between two point patterns", PAMI 1991. Yaw: the closed form of Zhang &
/// Scaramuzza, "A tutorial on quantitative trajectory evaluation for visual(-inertial) odometry", IROS 2018.
/// Where the positions do not determine the rotation, it is the chordal mean of the rotations between the two
/// trajectories' orientations. Throws InputError without pairs, and for Sim3 when the estimate or the
/// reference has no extent, so that the scale is undetermined.
Alignment align(AlignmentType type, const PosePairs& pairs);

/// Alignment of the first poses in the free directions of `type` (Yaw: position and yaw). Sim3 keeps `scale`,
/// which a single pose does not determine.
Alignment alignFirstPose(AlignmentType type, const PosePairs& pairs, double scale);

/// Reference direction of an estimate's heading.
enum class HeadingBasis {
  North,  ///< its y axis is north like that of the reference, so its heading has no free direction
  Start,  ///< its first heading is arbitrary
};

const char* toString(HeadingBasis basis);

/// Basis of a run from the name of its heading reference (`heading.reference` of run.json). Magnetic north
/// differs from the reference's north by a declination that such a run does not know.
HeadingBasis headingBasisOf(const std::string& heading_reference);

/// Alignment of the first positions and, with HeadingBasis::Start, of the first headings.
Alignment alignStarts(HeadingBasis basis, const PosePairs& pairs);

/// The estimate's poses in the world of the reference.
std::vector<Rigid3> applyAlignment(const Alignment& alignment, const std::vector<Rigid3>& estimate);

}  // namespace lodeline
