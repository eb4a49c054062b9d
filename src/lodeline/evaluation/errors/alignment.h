#pragma once

#include <string>
#include <vector>

#include "lodeline/evaluation/errors/association.h"
#include "lodeline/geometry/rigid3.h"

namespace lodeline {

/// Which transformation takes the world of the estimate to that of the reference before errors are measured.
/// The unobservable directions of the estimator decide: visual-inertial odometry cannot know position and yaw
/// (Yaw), a single camera alone not even the scale (Sim3).
enum class AlignmentType { None, Yaw, SE3, Sim3 };

/// "none", "yaw", "se3", "sim3" and back; UsageError for another name.
const char* toString(AlignmentType type);
AlignmentType alignmentTypeFromString(const std::string& name);

/// p_reference = scale * R * p_estimate + t.
struct Alignment {
  double scale = 1.0;
  Rigid3 reference_from_estimate;  ///< R and t (m); t is applied after the scale

  /// The positions do not fix the rotation (fewer than three, all in one place or on one line; for Yaw: no
  /// horizontal extent), so that it was taken from the orientations.
  bool rotation_from_orientations = false;

  Rigid3 apply(const Rigid3& estimate_world_from_body) const;

  /// By how much the estimate is too large, as a share of the true size: 1/scale - 1.
  double scaleError() const { return 1.0 / scale - 1.0; }
};

/// The least-squares alignment of the positions. SE3 and Sim3: Umeyama, "Least-squares estimation of
/// transformation parameters between two point patterns", PAMI 1991. Yaw: the closed form of Zhang &
/// Scaramuzza, "A tutorial on quantitative trajectory evaluation for visual(-inertial) odometry", IROS 2018.
/// Where the positions leave the rotation open it is the chordal mean of the rotations between the two
/// trajectories' orientations. Throws InputError without pairs, and for Sim3 when the estimate or the
/// reference has no extent, which leaves the scale open.
Alignment align(AlignmentType type, const PosePairs& pairs);

/// The alignment that makes the first poses coincide in what `type` leaves free (Yaw: position and yaw). Sim3
/// keeps `scale`, which a single pose cannot give.
Alignment alignFirstPose(AlignmentType type, const PosePairs& pairs, double scale);

/// What the heading of an estimate is measured from.
enum class HeadingBasis {
  North,  ///< its y axis claims to be north as the reference's: nothing about its heading is free
  Start,  ///< its first heading is arbitrary
};

const char* toString(HeadingBasis basis);

/// Of a run by its word for what its heading is counted from (`heading.reference` of run.json). Magnetic
/// north is off the reference's north by a declination that such a run does not know.
HeadingBasis headingBasisOf(const std::string& heading_reference);

/// Makes the first positions coincide and, with HeadingBasis::Start, the first headings.
Alignment alignStarts(HeadingBasis basis, const PosePairs& pairs);

/// The estimate's poses in the world of the reference.
std::vector<Rigid3> applyAlignment(const Alignment& alignment, const std::vector<Rigid3>& estimate);

}  // namespace lodeline
