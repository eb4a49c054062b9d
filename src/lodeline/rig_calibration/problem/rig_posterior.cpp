#include <ceres/crs_matrix.h>

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/rig_calibration/problem/rig_problem.h"

namespace lodeline {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// The blocks in the order of the columns: frames first, the calibration last.
struct BlockOrder {
  std::vector<double*> blocks;
  int columns = 0;
  int first_of_calibration = 0;

  /// Adds a block and returns its first column; -1 for a constant block.
  int add(const ceres::Problem& problem, double* block) {
    if (!problem.HasParameterBlock(block) || problem.IsParameterBlockConstant(block)) return -1;
    blocks.push_back(block);
    const int first = columns;
    columns += problem.ParameterBlockTangentSize(block);
    return first;
  }
};

Sparse sparseOf(const ceres::CRSMatrix& crs) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(crs.values.size());
  for (int row = 0; row < crs.num_rows; ++row) {
    for (int i = crs.rows[row]; i < crs.rows[row + 1]; ++i) {
      if (crs.values[i] != 0.0) entries.emplace_back(row, crs.cols[i], crs.values[i]);
    }
  }
  Sparse matrix(crs.num_rows, crs.num_cols);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// The last columns of the inverse of the information.
Eigen::MatrixXd lastColumnsOfInverse(const Sparse& jacobian, int first) {
  Sparse information = jacobian.transpose() * jacobian;
  // Scaled to a unit diagonal: the units of the blocks differ by many powers of ten.
  Eigen::VectorXd scale = information.diagonal();
  for (double& s : scale) s = s > 0.0 ? 1.0 / std::sqrt(s) : 1.0;
  information = scale.asDiagonal() * information * scale.asDiagonal();
  constexpr double kRounding = 1e-13;
  Sparse identity(information.rows(), information.cols());
  identity.setIdentity();
  information += kRounding * identity;
  const Eigen::SimplicialLDLT<Sparse> factor(information);
  if (factor.info() != Eigen::Success)
    throw EstimationError("the recording does not determine the calibration");
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(information.rows(), information.cols() - first);
  for (Eigen::Index k = 0; k < unit.cols(); ++k) unit(first + k, k) = scale[first + k];
  return scale.asDiagonal() * factor.solve(unit);
}

/// Raises the variances to those from the scatter of the frames, and keeps the correlations.
double inflate(const Eigen::VectorXd& scattered, Eigen::MatrixXd* covariance) {
  double largest = 1.0;
  Eigen::VectorXd ratio = Eigen::VectorXd::Ones(scattered.size());
  for (Eigen::Index i = 0; i < ratio.size(); ++i) {
    const double variance = (*covariance)(i, i);
    if (variance > 0.0) ratio[i] = std::sqrt(std::max(1.0, scattered[i] / variance));
    largest = std::max(largest, ratio[i]);
  }
  *covariance = ratio.asDiagonal() * *covariance * ratio.asDiagonal();
  return largest;
}

/// Raises the variances of the calibration where the frames scatter more than their curvature says.
double inflateByScatter(const Sparse& jacobian, const std::vector<double>& residuals,
                        const std::vector<int>& frame_of_row, size_t frames, const Eigen::MatrixXd& inverse,
                        Eigen::MatrixXd* covariance) {
  const Eigen::MatrixXd influence = jacobian * inverse;
  Eigen::MatrixXd by_frame = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(frames), inverse.cols());
  for (size_t row = 0; row < frame_of_row.size(); ++row)
    by_frame.row(frame_of_row[row]) += residuals[row] * influence.row(static_cast<Eigen::Index>(row));
  return inflate(by_frame.colwise().squaredNorm(), covariance);
}

/// Adds the blocks of the calibration and says where they are in its covariance.
std::vector<CameraColumns> addCalibration(const ceres::Problem& problem, RigState* state, BlockOrder* order) {
  order->first_of_calibration = order->columns;
  std::vector<CameraColumns> result;
  for (CameraState& camera : state->cameras) {
    const auto place = [&](double* block) {
      const int first = order->add(problem, block);
      return first < 0 ? -1 : first - order->first_of_calibration;
    };
    CameraColumns& columns = result.emplace_back();
    columns.lens = place(camera.lens.data());
    columns.port = place(camera.port.data());
    columns.extrinsics = place(camera.body_from_camera.data());
    columns.delay = place(&camera.delay_change_s);
  }
  return result;
}

}  // namespace

Posterior RigProblem::posterior() {
  BlockOrder order;
  for (FrameState& frame : state_->frames) {
    order.add(*problem_, frame.world_from_body.data());
    order.add(*problem_, frame.motion.data());
  }
  order.add(*problem_, state_->tilt.data());
  Posterior result;
  result.columns = addCalibration(*problem_, state_, &order);
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = order.blocks;
  std::vector<int> frame_of_row;
  for (size_t f = 0; f < by_frame_.size(); ++f) {
    for (const ceres::ResidualBlockId id : by_frame_[f]) {
      options.residual_blocks.push_back(id);
      const int rows = problem_->GetCostFunctionForResidualBlock(id)->num_residuals();
      frame_of_row.insert(frame_of_row.end(), static_cast<size_t>(rows), static_cast<int>(f));
    }
  }
  options.residual_blocks.insert(options.residual_blocks.end(), without_frame_.begin(), without_frame_.end());
  std::vector<double> residuals;
  ceres::CRSMatrix crs;
  problem_->Evaluate(options, nullptr, &residuals, nullptr, &crs);
  const Sparse jacobian = sparseOf(crs);
  const Eigen::MatrixXd inverse = lastColumnsOfInverse(jacobian, order.first_of_calibration);
  result.covariance = inverse.bottomRows(inverse.cols());
  result.largest_inflation =
      inflateByScatter(jacobian, residuals, frame_of_row, by_frame_.size(), inverse, &result.covariance);
  return result;
}

}  // namespace lodeline
