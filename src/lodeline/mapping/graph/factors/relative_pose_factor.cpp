#include "lodeline/mapping/graph/factors/relative_pose_factor.h"

#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/graph/factors/whitening.h"

namespace lodeline {

RelativePoseFactor::RelativePoseFactor(const RelativePose& measured)
    : from_from_to_(measured.from_from_to), whitening_(whiteningOf<6>(measured.covariance, "relative pose")) {
  checkPose(measured.from_from_to, "relative pose");
}

bool RelativePoseFactor::Evaluate(double const* const* parameters, double* residuals,
                                  double** jacobians) const {
  const Rigid3 from = poseFromBlock(parameters[0]), to = poseFromBlock(parameters[1]);
  const Rigid3 relative = from.inverse() * to;
  const Vec6 error = errorBetween(from_from_to_, relative);
  Eigen::Map<Vec6> whitened(residuals);
  whitened = whitening_ * error;
  if (!jacobians) return true;

  const Mat3 body_from_world = from.rotation.conjugate().toRotationMatrix();
  const Mat3 turn = so3::rightJacobianInverse(-error.tail<3>()) * body_from_world;
  for (int block = 0; block < 2; ++block) {
    if (!jacobians[block]) continue;
    const double sign = block == 0 ? -1.0 : 1.0;
    Mat6 derivative = Mat6::Zero();
    derivative.topLeftCorner<3, 3>() = sign * body_from_world;
    if (block == 0) {
      derivative.topRightCorner<3, 3>() = body_from_world * so3::skew(to.translation - from.translation);
    }
    derivative.bottomRightCorner<3, 3>() = sign * turn;
    writePoseJacobian<6>(whitening_ * derivative, jacobians[block]);
  }
  return true;
}

}  // namespace lodeline
