#pragma once

#include <vector>

#include "lodeline/evaluation/errors/association.h"
#include "lodeline/evaluation/errors/statistics.h"

namespace lodeline {

/// Differences of an aligned estimate from the reference for each pose. Rotation error matrix in the world: E
/// = R_estimate * R_reference^T; its angle is the rotation error, its yaw atan2(E(1,0), E(0,0)).
struct AbsoluteErrors {
  std::vector<Vec3> position_m;      ///< estimate minus reference, in the reference's world
  std::vector<double> rotation_deg;  ///< angle in [0, 180]
  std::vector<double> yaw_deg;       ///< about the world's z axis, signed, in [-180, 180]

  Statistics position() const;  ///< of the norms, m
  Statistics rotation() const;  ///< deg
  Statistics yaw() const;       ///< of the absolute values, deg
};

/// `aligned` holds the estimate's poses in the reference's world, one for each of `reference`.
AbsoluteErrors computeAbsoluteErrors(const std::vector<Rigid3>& aligned,
                                     const std::vector<Rigid3>& reference);

/// Start and end index of a section of the path.
struct Stretch {
  std::size_t start = 0;
  std::size_t end = 0;
};

/// One section for every start pose: the end is the pose whose distance along the path is closest to
/// `length_m`; start poses without one within `tolerance_m` are skipped. (Selection of Zhang & Scaramuzza
/// 2018, section V, who adopted it from KITTI.)
std::vector<Stretch> overlappingStretches(const std::vector<double>& distances_m, double length_m,
                                          double tolerance_m);

/// Consecutive sections that share only their ends; each ends at the first pose at least `length_m` of path
/// after its start. The first starts where the path is `length_m` long (the selection of evo 1.x for
/// "consecutive pairs").
std::vector<Stretch> consecutiveStretches(const std::vector<double>& distances_m, double length_m);

/// Errors of the relative motion over sections of one length, one value per section. E = (T_ref_start^-1
/// T_ref_end)^-1 (T_est_start^-1 T_est_end).
struct RelativeErrors {
  double length_m = 0.0;
  std::vector<double> translation_m;        ///< |translation of E|
  std::vector<double> translation_percent;  ///< of `length_m`
  std::vector<double> rotation_deg;         ///< angle of E
  std::vector<double> rotation_deg_per_m;   ///< of `length_m`
  std::vector<double> yaw_deg;              ///< |yaw| of E rotated into the world

  std::size_t size() const { return translation_m.size(); }
};

/// `aligned` needs the correct scale and a vertical z axis (yaw is that of R_est_end E R_est_end^T about z),
/// but not the correct position.
RelativeErrors computeRelativeErrors(const std::vector<Rigid3>& aligned, const std::vector<Rigid3>& reference,
                                     const std::vector<Stretch>& stretches, double length_m);

}  // namespace lodeline
