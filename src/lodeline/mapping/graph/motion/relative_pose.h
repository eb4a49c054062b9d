#pragma once

#include "lodeline/types.h"

namespace lodeline {

using Vec6 = Eigen::Matrix<double, 6, 1>;

/// Pose of a body `to` in the body `from`, with the covariance of its error [dp, dtheta] (m, rad) in axes of
/// `from`: true = (exp(dtheta) R, p + dp).
struct RelativePose {
  Rigid3 from_from_to;
  Mat6 covariance = Mat6::Zero();
};

/// Pose of c in a from those of b in a and of c in b, with independent errors. To first order
///   dp = dp_1 + dtheta_1 x (R_1 p_2) + R_1 dp_2,   dtheta = dtheta_1 + R_1 dtheta_2.
RelativePose composed(const RelativePose& a_from_b, const RelativePose& b_from_c);

/// Pose of `from` in `to`. To first order dp' = -R^T (dp + p x dtheta), dtheta' = -R^T dtheta.
RelativePose inverted(const RelativePose& pose);

/// Error [dp, dtheta] that takes the pose `estimate` to the pose `truth`, in axes of `from`.
Vec6 errorBetween(const Rigid3& estimate, const Rigid3& truth);

/// d^T C^-1 d of the error between two poses; infinite where the covariance is not positive definite.
double mahalanobisSquared(const Rigid3& estimate, const Rigid3& truth, const Mat6& covariance);

/// Throws InputError naming `what` unless the covariance is finite, symmetric and positive definite.
void checkCovariance(const Eigen::Ref<const Eigen::MatrixXd>& covariance, const char* what);
/// Throws InputError naming `what` unless the pose is finite and its quaternion has unit length.
void checkPose(const Rigid3& pose, const char* what);

}  // namespace lodeline
