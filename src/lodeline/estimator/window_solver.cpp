#include "lodeline/estimator/window_solver.h"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <unordered_map>
#include <vector>

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

struct Terms {
  std::vector<Factor> dense;  ///< prior and inertial terms
  std::vector<LandmarkFactors> landmarks;
};

Terms collectTerms(Window& window, const Prior& prior, const FactorMaker& factors) {
  Terms terms;
  if (!prior.empty()) terms.dense.push_back(factors.prior(prior));
  Frame* before = nullptr;
  for (const auto& frame : window.frames()) {
    if (before && frame->from_previous) terms.dense.push_back(factors.inertial(*before, *frame));
    before = frame.get();
  }
  for (auto& [id, track] : window.tracks()) {
    if (track.landmark) terms.landmarks.push_back(factors.landmark(window, track));
  }
  return terms;
}

/// The blocks of a problem, copied side by side. Ceres sorts blocks by their address; with addresses in the
/// order of frames and tracks, and not wherever the heap put them, two runs add up their sums in the same
/// order.
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
  options.function_tolerance = limits.function_tolerance;
  // Directions that only the whole window holds together (scale, tilt) have a curvature far below the
  // diagonal of their blocks; the default damping of 1e-4 of that diagonal would creep along them.
  options.initial_trust_region_radius = 1e9;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace

SolveSummary solveWindow(Window& window, const Prior& prior, const FactorMaker& factors,
                         const SolveLimits& limits) {
  repropagateWhereNeeded(window);
  Terms terms = collectTerms(window, prior, factors);
  BlockCopies copies;
  for (const LandmarkFactors& landmark : terms.landmarks) copies.add(landmark.landmark, kLandmarkSize);
  for (const auto& frame : window.frames()) {
    copies.add(frame->pose.data(), kPoseSize);
    if (frame->has_motion) copies.add(frame->motion.data(), kMotionSize);
  }

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
  const auto add = [&](const Factor& factor) {
    std::vector<double*> blocks;
    for (const double* block : factor.blocks) blocks.push_back(copies.copyOf(block));
    // Ceres takes no notice of the loss's constness.
    problem.AddResidualBlock(factor.function.get(), const_cast<ceres::LossFunction*>(factor.loss), blocks);
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
  if (summary.usable) copies.writeBack();
  return summary;
}

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

Eigen::Matrix<double, 15, 15> newestCovariance(Window& window, const Prior& prior,
                                               const FactorMaker& factors) {
  NormalEquations system;
  const Terms terms = collectTerms(window, prior, factors);
  for (const Factor& factor : terms.dense) system.add(factor);
  for (const LandmarkFactors& landmark : terms.landmarks) system.addEliminated(landmark);
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
