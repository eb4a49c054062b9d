#include "lodeline/estimator/covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "lodeline/estimator/window_terms.h"

namespace lodeline {

double scaleUncertainty(const Frame& newest, const Eigen::Matrix<double, 15, 15>& covariance) {
  const auto along = [](const Vec3& vector, const Mat3& vector_covariance) {
    const double length = vector.norm();
    if (length < 1e-9) return std::numeric_limits<double>::infinity();
    const Vec3 direction = vector / length;
    return std::sqrt(direction.dot(vector_covariance * direction)) / length;
  };
  return std::min(along(newest.worldFromBody().translation, covariance.block<3, 3>(0, 0)),
                  along(newest.velocity_W(), covariance.block<3, 3>(6, 6)));
}

Eigen::Matrix<double, 15, 15> covarianceOf(const NormalEquations& system, const Frame& frame) {
  const Eigen::MatrixXd hessian = system.hessian();
  const int pose_row = system.find(frame.pose.data())->offset;
  const int motion_row = system.find(frame.motion.data())->offset;
  const Eigen::VectorXd scale = hessian.diagonal().cwiseMax(1e-12).cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Eigen::MatrixXd> factorised(scale.asDiagonal() * hessian * scale.asDiagonal());
  Eigen::MatrixXd selection = Eigen::MatrixXd::Zero(system.size(), 15);
  for (int i = 0; i < 6; ++i) selection(pose_row + i, i) = scale[pose_row + i];
  for (int i = 0; i < 9; ++i) selection(motion_row + i, 6 + i) = scale[motion_row + i];
  const Eigen::MatrixXd columns = scale.asDiagonal() * factorised.solve(selection);
  Eigen::Matrix<double, 15, 15> covariance;
  covariance << columns.middleRows<6>(pose_row), columns.middleRows<9>(motion_row);
  return 0.5 * (covariance + covariance.transpose());
}

Eigen::Matrix<double, 15, 15> newestCovariance(Window& window, const Prior& prior,
                                               const FactorMaker& factors) {
  return covarianceOf(linearise(collectTerms(window, prior, factors)), window.newest());
}

}  // namespace lodeline
