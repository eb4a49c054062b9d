#include "lodeline/estimator/window_solver.h"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "lodeline/estimator/normal_equations.h"

namespace lodeline {
namespace {

void repropagateWhereNeeded(Window& window) {
  const Frame* before = nullptr;
  for (const auto& frame : window.frames()) {
    if (before && before->has_motion && frame->from_previous &&
        frame->from_previous->needsRepropagation(before->gyroscopeBias(), before->accelerometerBias())) {
      frame->from_previous->repropagate(before->gyroscopeBias(), before->accelerometerBias());
    }
    before = frame.get();
  }
}

/// Calls `visit` for the prior and all inertial terms, then `visit_landmark` for each landmark's terms.
template <typename Visit, typename VisitLandmark>
void forEachTerm(Window& window, const Prior& prior, const FactorMaker& factors, const Visit& visit,
                 const VisitLandmark& visit_landmark) {
  if (!prior.empty()) visit(factors.prior(prior));
  Frame* before = nullptr;
  for (const auto& frame : window.frames()) {
    if (before && frame->from_previous) visit(factors.inertial(*before, *frame));
    before = frame.get();
  }
  for (auto& [id, track] : window.tracks()) {
    if (track.landmark) visit_landmark(factors.landmark(window, track));
  }
}

ceres::Problem::Options problemOptions() {
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  return options;
}

}  // namespace

SolveSummary solveWindow(Window& window, const Prior& prior, const FactorMaker& factors,
                         const SolveLimits& limits) {
  repropagateWhereNeeded(window);
  PoseManifold pose_manifold;
  ceres::Problem problem(problemOptions());
  ceres::Solver::Options solver_options;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (const auto& frame : window.frames()) {
    problem.AddParameterBlock(frame->pose.data(), kPoseSize, &pose_manifold);
    ordering->AddElementToGroup(frame->pose.data(), 1);
    if (!frame->has_motion) continue;
    problem.AddParameterBlock(frame->motion.data(), kMotionSize);
    ordering->AddElementToGroup(frame->motion.data(), 1);
  }
  const auto add = [&](Factor&& factor) {
    // Ceres frees what it is given and takes no notice of the loss's constness.
    problem.AddResidualBlock(factor.function.release(), const_cast<ceres::LossFunction*>(factor.loss),
                             factor.blocks);
  };
  forEachTerm(window, prior, factors, add, [&](LandmarkFactors&& landmark) {
    for (Factor& factor : landmark.factors) add(std::move(factor));
    ordering->AddElementToGroup(landmark.landmark, 0);
  });

  solver_options.linear_solver_type = ceres::DENSE_SCHUR;
  solver_options.linear_solver_ordering = ordering;
  solver_options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  solver_options.max_num_iterations = limits.max_iterations;
  solver_options.function_tolerance = limits.function_tolerance;
  // Directions that only the whole window holds together (scale, tilt) have a curvature far below the
  // diagonal of their blocks; the default damping of 1e-4 of that diagonal would creep along them.
  solver_options.initial_trust_region_radius = 1e9;
  solver_options.num_threads = 1;
  solver_options.logging_type = ceres::SILENT;
  ceres::Solver::Summary ceres_summary;
  ceres::Solve(solver_options, &problem, &ceres_summary);

  SolveSummary summary;
  summary.iterations = static_cast<int>(ceres_summary.iterations.size());
  summary.initial_cost = ceres_summary.initial_cost;
  summary.final_cost = ceres_summary.final_cost;
  summary.usable = ceres_summary.IsSolutionUsable();
  return summary;
}

double scaleUncertainty(const Frame& newest, const Eigen::Matrix<double, 15, 15>& covariance) {
  const auto along = [](const Vec3& vector, const Mat3& vector_covariance) {
    const double length = std::max(vector.norm(), 1e-9);
    const Vec3 direction = vector / length;
    return std::sqrt(direction.dot(vector_covariance * direction)) / length;
  };
  return std::min(along(newest.worldFromBody().translation, covariance.block<3, 3>(0, 0)),
                  along(newest.velocity_W(), covariance.block<3, 3>(6, 6)));
}

Eigen::Matrix<double, 15, 15> newestCovariance(Window& window, const Prior& prior,
                                               const FactorMaker& factors) {
  NormalEquations system;
  forEachTerm(
      window, prior, factors, [&](const Factor& factor) { system.add(factor); },
      [&](const LandmarkFactors& landmark) { system.addEliminated(landmark); });
  const Frame& newest = window.newest();
  const int pose_row = system.find(newest.pose.data())->offset;
  const int motion_row = system.find(newest.motion.data())->offset;
  const Eigen::MatrixXd h = system.hessian();
  const Eigen::VectorXd scale = h.diagonal().cwiseMax(1e-12).cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Eigen::MatrixXd> factorised(scale.asDiagonal() * h * scale.asDiagonal());
  Eigen::MatrixXd selection = Eigen::MatrixXd::Zero(system.size(), 15);
  for (int i = 0; i < 6; ++i) selection(pose_row + i, i) = scale[pose_row + i];
  for (int i = 0; i < 9; ++i) selection(motion_row + i, 6 + i) = scale[motion_row + i];
  const Eigen::MatrixXd columns = scale.asDiagonal() * factorised.solve(selection);
  Eigen::Matrix<double, 15, 15> covariance;
  covariance << columns.middleRows<6>(pose_row), columns.middleRows<9>(motion_row);
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace lodeline
