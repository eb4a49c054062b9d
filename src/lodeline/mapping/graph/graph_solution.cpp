#include <ceres/crs_matrix.h>
#include <fmt/format.h>

#include <Eigen/SparseCore>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/graph/graph_factorization.h"
#include "lodeline/mapping/graph/graph_problem.h"

namespace lodeline {

ceres::Solver::Summary GraphProblem::solve(int most_iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.num_threads = 1;
  options.max_num_iterations = most_iterations;
  options.logging_type = ceres::SILENT;
  // Steps begin undamped: the start is close, and the weak priors keep every part determined.
  options.initial_trust_region_radius = 1e10;
  options.max_trust_region_radius = 1e16;
  options.function_tolerance = 1e-7;
  options.parameter_tolerance = 1e-10;
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem_.get(), &summary);
  if (summary.termination_type == ceres::FAILURE) {
    throw EstimationError(fmt::format("the pose graph has no solution: {}", summary.message));
  }
  return summary;
}

void GraphProblem::setWeight(ReportedFactor* factor, double weight) {
  factor->loss.weight = weight;
  if (weight > 0.0 && !factor->block) {
    factor->block = problem_->AddResidualBlock(factor->function.get(), &factor->loss, factor->parameters);
  } else if (weight <= 0.0 && factor->block) {
    problem_->RemoveResidualBlock(factor->block);
    factor->block = nullptr;
  }
}

void GraphProblem::restoreChains() {
  for (const std::vector<KeyframeId>& chain : chains_.nodes()) {
    const Rigid3 world_from_first = pose(chain.front());
    for (const KeyframeId id : chain) {
      if (id == chain.front()) continue;
      poseToBlock(world_from_first * chains_.relative(chain.front(), id).from_from_to,
                  nodes_.at(id).pose.data());
    }
  }
}

double GraphProblem::chiSquared(const ReportedFactor& factor) const {
  Eigen::VectorXd whitened(factor.function->num_residuals());
  if (!factor.function->Evaluate(factor.parameters.data(), whitened.data(), nullptr)) {
    throw EstimationError("the pose graph: a residual has no value");
  }
  return whitened.squaredNorm();
}

std::shared_ptr<const GraphCovariance::Factorization> GraphProblem::factorization() {
  hold();
  auto result = std::make_shared<GraphCovariance::Factorization>();
  ceres::Problem::EvaluateOptions options;
  options.num_threads = 1;
  int column = 0;
  for (auto& [id, state] : nodes_) {
    result->nodes[id] = {column, state.free_axes, poseFromBlock(state.pose.data())};
    if (state.free_axes.empty()) continue;
    options.parameter_blocks.push_back(state.pose.data());
    column += static_cast<int>(state.free_axes.size());
  }
  for (auto& [dive, number] : azimuths_) options.parameter_blocks.push_back(&number.value);
  for (auto& [dive, number] : height_offsets_) options.parameter_blocks.push_back(&number.value);
  if (!surface_.prior.blocks.empty()) options.parameter_blocks.push_back(&surface_.value);
  for (auto& [name, seen] : landmarks_) options.parameter_blocks.push_back(seen.position_W.data());

  ceres::CRSMatrix rows;
  if (options.parameter_blocks.empty() || !problem_->Evaluate(options, nullptr, nullptr, nullptr, &rows)) {
    throw EstimationError("the pose graph is empty or has residuals without a value");
  }
  const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> by_rows(
      rows.num_rows, rows.num_cols, static_cast<Eigen::Index>(rows.values.size()), rows.rows.data(),
      rows.cols.data(), rows.values.data());
  const Eigen::SparseMatrix<double> jacobian = by_rows;
  result->normal.compute(jacobian.transpose() * jacobian);
  if (result->normal.info() != Eigen::Success) {
    throw EstimationError(
        "the covariance of the pose graph does not exist: its measurements leave a "
        "direction open");
  }
  return result;
}

}  // namespace lodeline
