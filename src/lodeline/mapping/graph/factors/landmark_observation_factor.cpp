#include "lodeline/mapping/graph/factors/landmark_observation_factor.h"

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/graph/factors/whitening.h"

namespace lodeline {

LandmarkObservationFactor::LandmarkObservationFactor(const Vec3& point_B, const Mat3& covariance)
    : point_B_(point_B), whitening_(whiteningOf<3>(covariance, "observation")) {
  if (!point_B.allFinite()) throw InputError("observation: the point is not finite");
}

bool LandmarkObservationFactor::Evaluate(double const* const* parameters, double* residuals,
                                         double** jacobians) const {
  const Rigid3 world_from_body = poseFromBlock(parameters[0]);
  const Vec3 way_W = Eigen::Map<const Vec3>(parameters[1]) - world_from_body.translation;
  const Mat3 body_from_world = world_from_body.rotation.conjugate().toRotationMatrix();
  Eigen::Map<Vec3> whitened(residuals);
  whitened = whitening_ * (body_from_world * way_W - point_B_);
  if (!jacobians) return true;
  const Mat3 by_point = whitening_ * body_from_world;
  if (jacobians[0]) {
    Eigen::Matrix<double, 3, 6> derivative;
    derivative << -by_point, by_point * so3::skew(way_W);
    writePoseJacobian<3>(derivative, jacobians[0]);
  }
  if (jacobians[1]) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> by_landmark(jacobians[1]);
    by_landmark = by_point;
  }
  return true;
}

}  // namespace lodeline
