#pragma once

#include <vector>

#include "lodeline/mapping/recognition/verification/loop_geometry.h"

namespace lodeline {

/// What gravity says about the rotation between two keyframes.
struct CommonVertical {
  Vec3 up_old = Vec3::UnitZ(), up_new = Vec3::UnitZ();  ///< unit, in each body
  double sigma_rad = 0.01;

  CommonVertical(const MapKeyframe& old_keyframe, const MapKeyframe& new_keyframe)
      : up_old(upInBody(old_keyframe)),
        up_new(upInBody(new_keyframe)),
        sigma_rad(tiltSigma_rad(old_keyframe, new_keyframe)) {}

  /// Whitened components of R up_new normal to up_old, and their Jacobian by [dp, dtheta].
  Vec2 residual(const Quat& old_from_new, Eigen::Matrix<double, 2, 6>* by_pose) const;
};

/// Result of refinePose().
struct RefinedPose {
  Rigid3 old_from_new;
  Mat6 information = Mat6::Zero();  ///< of [dp, dtheta], by the stated sigmas
  bool is_determined = false;       ///< the information has full rank
};

/// Pose with the smallest sum of robust squared residuals (Cauchy loss) of the used pairs and the vertical.
/// Levenberg-Marquardt in all six coordinates.
RefinedPose refinePose(const std::vector<LoopCorrespondence>& pairs, const std::vector<bool>& is_used,
                       const CommonVertical& vertical, const Rigid3& start, int iterations);

/// Information of a pose without what is only noise of the positions. Points that are scattered in depth fix
/// a turn against a shift, but a scatter by errors of their distances seems to do so too. The expected part
/// of it is the sum of dJ^T dJ, with the change dJ of the Jacobian by one sigma of the distance. It is
/// subtracted; at least a thousandth is left in each direction.
Mat6 informationOfStructure(const std::vector<LoopCorrespondence>& pairs, const std::vector<bool>& is_used,
                            const RefinedPose& pose);

/// Factor by which the covariance of a pose exceeds the inverse of its information: the design effect. The
/// gradients g of the inliers of one group (cell of a view) are summed, because neighbours have similar
/// errors. With the sum S of the squares of these sums, the factor is trace(information^-1 S) / 6, at least
/// 1: the mean over all directions of the covariance that is robust to dependence within groups (K.-Y. Liang
/// and S. Zeger, "Longitudinal data analysis using generalized linear models", Biometrika 1986).
double designEffect(const std::vector<LoopCorrespondence>& pairs, const std::vector<bool>& is_used,
                    const std::vector<int>& groups, const RefinedPose& pose);

}  // namespace lodeline
