#include "lodeline/mapping/graph/factors/position_factor.h"

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/graph/factors/whitening.h"

namespace lodeline {

PositionFactor::PositionFactor(const Vec3& position_W, const Mat3& covariance, const Vec3& point_B)
    : position_W_(position_W), point_B_(point_B), whitening_(whiteningOf<3>(covariance, "position")) {
  if (!position_W.allFinite() || !point_B.allFinite()) throw InputError("position: a point is not finite");
}

bool PositionFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Rigid3 world_from_body = poseFromBlock(parameters[0]);
  const Vec3 lever_W = world_from_body.rotation * point_B_;
  Eigen::Map<Vec3> whitened(residuals);
  whitened = whitening_ * (world_from_body.translation + lever_W - position_W_);
  if (!jacobians || !jacobians[0]) return true;
  Eigen::Matrix<double, 3, 6> derivative;
  derivative << Mat3::Identity(), -so3::skew(lever_W);
  writePoseJacobian<3>(whitening_ * derivative, jacobians[0]);
  return true;
}

}  // namespace lodeline
