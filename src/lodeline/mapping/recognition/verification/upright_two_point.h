#pragma once

#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// A point of the frame S and a ray of the frame T that passes through it. Both frames have the z axis up.
struct PointOnRay {
  Vec3 point_S = Vec3::Zero();
  Vec3 origin_T = Vec3::Zero();
  Vec3 bearing_T = Vec3::UnitX();  ///< unit
};

/// Poses T from S, with a rotation about the vertical only, at which two points lie on their rays: at most
/// two. Rays of one camera or of several are equal to it (generalized camera).
///
/// With R the rotation by the yaw a, each point gives t = lambda b + o - R p. The difference of both
/// equations, multiplied by n = b_1 x b_2, does not contain the distances lambda:
///
///     n . (R (p_1 - p_2)) = n . (o_1 - o_2),   or   A cos a + B sin a = C.
///
/// It has the solutions a = atan2(B, A) +- acos(C / |(A, B)|). The distances follow from the two rays by
/// least squares; solutions with a point behind its ray are dropped. (For the problem with a central camera
/// see Z. Kukelova, M. Bujnak and T. Pajdla, "Closed-form solutions to minimal absolute pose problems with
/// known vertical direction", ACCV 2010.)
std::vector<Rigid3> posesOfTwoPoints(const PointOnRay& first, const PointOnRay& second);

}  // namespace lodeline
