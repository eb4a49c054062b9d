#pragma once

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "lodeline/factors/parameters.h"

namespace lodeline {

/// Test support: compares a cost function's analytic Jacobians with fourth-order central differences.
/// Differences go through the pose manifold for blocks of size 7, through plain addition for the others. The
/// largest deviation in a block, relative to the block's largest entry, must stay below `tolerance`.
inline void expectJacobiansMatch(const ceres::CostFunction& function,
                                 const std::vector<Eigen::VectorXd>& parameters, double tolerance = 1e-6) {
  const int rows = function.num_residuals();
  std::vector<const double*> pointers;
  for (const auto& block : parameters) pointers.push_back(block.data());

  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<RowMajor> analytic;
  for (const auto& block : parameters) analytic.push_back(RowMajor::Constant(rows, block.size(), 1e300));
  std::vector<double*> jacobians;
  for (auto& jacobian : analytic) jacobians.push_back(jacobian.data());
  Eigen::VectorXd residual(rows);
  ASSERT_TRUE(function.Evaluate(pointers.data(), residual.data(), jacobians.data()));

  for (size_t b = 0; b < parameters.size(); ++b) {
    const bool is_pose = parameters[b].size() == kPoseSize;
    const int tangent = is_pose ? kPoseTangentSize : static_cast<int>(parameters[b].size());
    Eigen::MatrixXd numeric(rows, tangent);
    for (int i = 0; i < tangent; ++i) {
      const double step = 1e-4 * (is_pose ? 1.0 : std::max(1e-2, std::abs(parameters[b][i])));
      const auto at = [&](double offset) {
        Eigen::VectorXd delta = Eigen::VectorXd::Zero(tangent);
        delta[i] = offset;
        Eigen::VectorXd moved = parameters[b];
        if (is_pose) {
          PoseManifold().Plus(parameters[b].data(), delta.data(), moved.data());
        } else {
          moved += delta;
        }
        std::vector<const double*> moved_pointers = pointers;
        moved_pointers[b] = moved.data();
        Eigen::VectorXd value(rows);
        EXPECT_TRUE(function.Evaluate(moved_pointers.data(), value.data(), nullptr));
        return value;
      };
      numeric.col(i) = (8.0 * (at(step) - at(-step)) - (at(2.0 * step) - at(-2.0 * step))) / (12.0 * step);
    }
    const double scale = std::max(numeric.cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((analytic[b].leftCols(tangent) - numeric).cwiseAbs().maxCoeff() / scale, tolerance)
        << "block " << b << "\nanalytic\n"
        << analytic[b].leftCols(tangent) << "\nnumeric\n"
        << numeric;
    if (is_pose) {
      EXPECT_EQ(analytic[b].col(6).cwiseAbs().maxCoeff(), 0.0) << "block " << b;
    }
  }
}

/// A pose as a parameter block that owns its memory.
inline Eigen::VectorXd poseVector(const Rigid3& world_from_body) {
  Eigen::VectorXd block(kPoseSize);
  poseToBlock(world_from_body, block.data());
  return block;
}

}  // namespace lodeline
