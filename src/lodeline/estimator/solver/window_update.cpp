#include "lodeline/estimator/solver/window_update.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "lodeline/estimator/problem/covariance.h"
#include "lodeline/estimator/problem/prior_terms.h"
#include "lodeline/estimator/problem/window_cholesky.h"
#include "lodeline/estimator/visual/reprojection_system.h"

namespace lodeline {
namespace {

/// Copy of all blocks that a step changes, to restore them after a step that did not reduce the cost.
class Snapshot {
 public:
  Snapshot(const Window& window, const std::vector<double*>& landmarks) {
    for (const auto& frame : window.frames()) {
      save(frame->pose.data(), kPoseSize);
      save(frame->motion.data(), kMotionSize);
    }
    for (const auto& state : window.globals())
      save(state->value.data(), static_cast<int>(state->value.size()));
    for (double* landmark : landmarks) save(landmark, kLandmarkSize);
  }
  void restore() const {
    const double* value = values_.data();
    for (const auto& [target, size] : targets_) {
      std::copy_n(value, size, target);
      value += size;
    }
  }

 private:
  void save(double* value, int size) {
    targets_.emplace_back(value, size);
    values_.insert(values_.end(), value, value + size);
  }
  std::vector<std::pair<double*, int>> targets_;
  std::vector<double> values_;
};

int tangentSizeOf(const Window& window) {
  int size = 0;
  for (const auto& frame : window.frames()) {
    if (!frame->interpolated) size += kPoseTangentSize + (frame->has_motion ? kMotionSize : 0);
  }
  for (const auto& state : window.globals()) size += state->tangentSize();
  return size;
}

/// All terms of a window, in a form that is fast to evaluate repeatedly.
class QuickTerms {
 public:
  QuickTerms(Window& window, const Prior& prior, const FactorBuilder& factors,
             const LandmarkLinearizationCache& frozen)
      : prior_(prior),
        motion_(collectMotionTerms(window, factors)),
        visual_(window, factors, ReprojectionSystem::Of::kLive),
        linearization_cache_(frozen),
        size_(tangentSizeOf(window)) {}

  /// Called after blocks have changed.
  void update() { visual_.update(); }

  double cost() {
    double cost = prior_.cost() + visual_.cost() + linearization_cache_.cost();
    for (const Factor& factor : motion_) cost += costOf(factor, residual_);
    return cost;
  }

  std::vector<double> errors() const { return visual_.errors(); }

  Snapshot snapshot(const Window& window) const { return {window, visual_.landmarks()}; }

  NormalEquations linearize() {
    NormalEquations system;
    system.reserve(size_);
    prior_.addTo(&system);
    for (const Factor& factor : motion_) system.add(factor);
    visual_.addTo(&system);
    linearization_cache_.addTo(&system);
    return system;
  }

  void apply(Window& window, const NormalEquations& system, const Eigen::VectorXd& step) {
    for (const NormalEquations::Block& block : system.blocks()) {
      if (block.ambient_size == kPoseSize) {
        poseToBlock(perturbed(poseFromBlock(block.value), step.segment<6>(block.offset)), block.value);
      } else {
        Eigen::Map<Eigen::VectorXd>(block.value, block.ambient_size) +=
            step.segment(block.offset, block.ambient_size);
      }
    }
    visual_.stepLandmarks(system, step);
    window.placeInterpolated();
    update();
  }

 private:
  PriorTerms prior_;
  std::vector<Factor> motion_;
  ReprojectionSystem visual_;
  const LandmarkLinearizationCache& linearization_cache_;
  int size_;
  std::vector<double> residual_;
};

}  // namespace

WindowUpdate updateWindow(Window& window, const Prior& prior, const FactorBuilder& factors,
                          const SolveLimits& limits, const LandmarkLinearizationCache& frozen) {
  // The first step is undamped. After darkness the window as a whole is known to metres, and its frames
  // relative to each other to micrometres. Any damping that is small relative to the latter would hold the
  // whole window at its dead-reckoning position.
  constexpr double kLeastDamping = 1e-9;
  constexpr double kMostDamping = 1e-1;
  QuickTerms terms(window, prior, factors, frozen);
  WindowUpdate update;
  double cost = terms.cost();
  update.summary.initial_cost = cost;
  double damping = 0.0;
  NormalEquations system;
  std::vector<const double*> correlated;
  std::optional<WindowCholesky> cholesky;
  bool is_damped = false;
  while (update.summary.iterations < limits.max_iterations) {
    ++update.summary.iterations;
    system = terms.linearize();
    correlated = correlatedBlocks(system, window);
    cholesky.emplace(system, motionsButTheNewest(window), correlated);
    const Snapshot before = terms.snapshot(window);
    double gain = 0.0;
    while (!(gain > 0.0) && damping <= kMostDamping) {
      is_damped = damping > 0.0;
      if (cholesky->factorize(damping)) {
        terms.apply(window, system, -cholesky->solve(system.gradient()));
        gain = cost - terms.cost();
        if (!(gain > 0.0)) {
          before.restore();
          terms.update();
        }
      }
      damping = gain > 0.0 ? 0.01 * damping : std::max(kLeastDamping, 100.0 * damping);
    }
    if (damping < kLeastDamping) damping = 0.0;
    if (!(gain > limits.function_tolerance * cost)) break;
    cost -= gain;
  }
  update.summary.final_cost = cost;
  update.summary.usable = std::isfinite(cost);
  update.covariance = is_damped ? JointCovariance(system, window)
                                : JointCovariance(system, correlated, cholesky->covarianceOfLast());
  update.errors_sigmas = terms.errors();
  return update;
}

}  // namespace lodeline
