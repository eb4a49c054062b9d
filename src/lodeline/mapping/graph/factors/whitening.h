#pragma once

#include <Eigen/Cholesky>

#include "lodeline/factors/parameters.h"
#include "lodeline/mapping/graph/motion/relative_pose.h"

namespace lodeline {

/// Whitening matrix L^-1 of a covariance C = L L^T. Throws InputError naming `what` unless C is positive
/// definite.
template <int kSize>
Eigen::Matrix<double, kSize, kSize> whiteningOf(const Eigen::Matrix<double, kSize, kSize>& covariance,
                                                const char* what) {
  checkCovariance(covariance, what);
  const Eigen::LLT<Eigen::Matrix<double, kSize, kSize>> factor(covariance);
  return factor.matrixL().solve(Eigen::Matrix<double, kSize, kSize>::Identity());
}

/// Writes a derivative by the 6 perturbations of a pose into the 7 columns of its block, see parameters.h.
template <int kRows>
void writePoseJacobian(const Eigen::Matrix<double, kRows, kPoseTangentSize>& derivative, double* jacobian) {
  // Eigen demands that a single row is stored by rows, which is what Ceres needs for every number of rows.
  Eigen::Map<Eigen::Matrix<double, kRows, kPoseSize, Eigen::RowMajor>> columns(jacobian);
  columns.template leftCols<kPoseTangentSize>() = derivative;
  columns.col(kPoseTangentSize).setZero();
}

}  // namespace lodeline
