#include "lodeline/estimator/solver/window_solver.h"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <unordered_map>
#include <vector>

#include "lodeline/problem/normal_equations.h"
#include "lodeline/problem/window_terms.h"

namespace lodeline {
namespace {

/// Copies of a problem's blocks in contiguous memory. Ceres sorts blocks by their address. With addresses in
/// the order of frames and tracks, and not of the heap, two runs add their sums in the same order.
class BlockCopies {
 public:
  void add(double* original, int size) {
    blocks_.push_back({original, static_cast<int>(values_.size()), size});
    values_.insert(values_.end(), original, original + size);
    offsets_[original] = blocks_.back().offset;
  }
  double* copyOf(const double* original) { return values_.data() + offsets_.at(original); }
  void writeBack() const {
    for (const Block& block : blocks_) std::copy_n(values_.data() + block.offset, block.size, block.original);
  }

 private:
  struct Block {
    double* original;
    int offset;
    int size;
  };
  std::vector<Block> blocks_;
  std::vector<double> values_;
  std::unordered_map<const double*, int> offsets_;
};

ceres::Problem::Options problemOptions() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  return options;
}

ceres::Solver::Options solverOptions(const SolveLimits& limits) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  options.max_num_iterations = limits.max_iterations;
  options.function_tolerance = limits.relative_gain;
  // Directions that only the whole window determines (scale, tilt) have a curvature far below the diagonal of
  // their blocks. The default damping of 1e-4 of that diagonal would make convergence along them very slow.
  options.initial_trust_region_radius = 1e9;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace

SolveSummary solveWithCeres(Window& window, const Prior& prior, const FactorBuilder& factors,
                            const SolveLimits& limits) {
  const WindowTerms terms = collectTerms(window, prior, factors);
  BlockCopies copies;
  for (const LandmarkFactors& landmark : terms.landmarks) copies.add(landmark.landmark, kLandmarkSize);
  for (const auto& frame : window.frames()) {
    copies.add(frame->pose.data(), kPoseSize);
    if (frame->has_motion) copies.add(frame->motion.data(), kMotionSize);
  }
  for (const auto& state : window.globals())
    copies.add(state->value.data(), static_cast<int>(state->value.size()));

  PoseManifold pose_manifold;
  ceres::Problem problem(problemOptions());
  const ceres::Solver::Options options = solverOptions(limits);
  for (const auto& frame : window.frames()) {
    double* pose = copies.copyOf(frame->pose.data());
    problem.AddParameterBlock(pose, kPoseSize, &pose_manifold);
    options.linear_solver_ordering->AddElementToGroup(pose, 1);
    if (!frame->has_motion) continue;
    double* motion = copies.copyOf(frame->motion.data());
    problem.AddParameterBlock(motion, kMotionSize);
    options.linear_solver_ordering->AddElementToGroup(motion, 1);
  }
  for (const auto& state : window.globals()) {
    double* value = copies.copyOf(state->value.data());
    problem.AddParameterBlock(value, static_cast<int>(state->value.size()),
                              state->isPose() ? &pose_manifold : nullptr);
    options.linear_solver_ordering->AddElementToGroup(value, 1);
  }
  const auto add = [&](const Factor& factor) {
    std::vector<double*> blocks;
    for (const double* block : factor.blocks) blocks.push_back(copies.copyOf(block));
    // Ceres does not modify the loss, although its interface is not const.
    problem.AddResidualBlock(factor.function.get(), const_cast<ceres::LossFunction*>(factor.loss.get()),
                             blocks);
  };
  for (const Factor& factor : terms.dense) add(factor);
  for (const LandmarkFactors& landmark : terms.landmarks) {
    for (const Factor& factor : landmark.factors) add(factor);
    options.linear_solver_ordering->AddElementToGroup(copies.copyOf(landmark.landmark), 0);
  }
  ceres::Solver::Summary ceres_summary;
  ceres::Solve(options, &problem, &ceres_summary);

  SolveSummary summary;
  summary.iterations = static_cast<int>(ceres_summary.iterations.size());
  summary.initial_cost = ceres_summary.initial_cost;
  summary.final_cost = ceres_summary.final_cost;
  summary.usable = ceres_summary.IsSolutionUsable();
  summary.converged = ceres_summary.termination_type == ceres::CONVERGENCE;
  if (summary.usable) copies.writeBack();
  return summary;
}

}  // namespace lodeline
