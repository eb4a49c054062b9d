#include "lodeline/estimator/solver/window_update.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "lodeline/estimator/solver/levenberg_marquardt.h"
#include "lodeline/estimator/visual/reprojection_system.h"
#include "lodeline/problem/covariance.h"
#include "lodeline/problem/prior_terms.h"
#include "lodeline/problem/window_cholesky.h"

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

/// All terms of a window, in a form that is fast to evaluate repeatedly; the problem of minimize().
class QuickTerms {
 public:
  QuickTerms(Window& window, const Prior& prior, const FactorBuilder& factors,
             const LandmarkLinearizationCache& frozen)
      : window_(window),
        prior_(prior),
        motion_(collectMotionTerms(window, factors)),
        visual_(window, factors, ReprojectionSystem::Of::kLive),
        linearization_cache_(frozen),
        size_(tangentSizeOf(window)) {}

  double cost() {
    double cost = prior_.cost() + visual_.cost() + linearization_cache_.cost();
    for (const Factor& factor : motion_) cost += costOf(factor, residual_);
    return cost;
  }

  std::vector<double> errors() const { return visual_.errors(); }

  void linearize() {
    before_.emplace(window_, visual_.landmarks());
    system_ = NormalEquations();
    system_.reserve(size_);
    prior_.addTo(&system_);
    for (const Factor& factor : motion_) system_.add(factor);
    visual_.addTo(&system_);
    linearization_cache_.addTo(&system_);
    correlated_ = correlatedBlocks(system_, window_);
    cholesky_.emplace(system_, motionsButTheNewest(window_), correlated_);
  }

  bool step(double damping) {
    is_damped_ = damping > 0.0;
    if (!cholesky_->factorize(damping)) return false;
    apply(-cholesky_->solve(system_.gradient()));
    return true;
  }

  void restore() {
    before_->restore();
    visual_.update();
  }

  /// Covariance with the Jacobians of the last step.
  JointCovariance covariance() const {
    return is_damped_ ? JointCovariance(system_, window_)
                      : JointCovariance(system_, correlated_, cholesky_->covarianceOfLast());
  }

 private:
  void apply(const Eigen::VectorXd& step) {
    for (const NormalEquations::Block& block : system_.blocks()) {
      if (block.ambient_size == kPoseSize) {
        poseToBlock(perturbed(poseFromBlock(block.value), step.segment<6>(block.offset)), block.value);
      } else {
        Eigen::Map<Eigen::VectorXd>(block.value, block.ambient_size) +=
            step.segment(block.offset, block.ambient_size);
      }
    }
    visual_.stepLandmarks(system_, step);
    window_.placeInterpolated();
    visual_.update();
  }

  Window& window_;
  PriorTerms prior_;
  std::vector<Factor> motion_;
  ReprojectionSystem visual_;
  const LandmarkLinearizationCache& linearization_cache_;
  int size_;
  std::vector<double> residual_;
  // Of the last linearization:
  NormalEquations system_;
  std::vector<const double*> correlated_;
  std::optional<WindowCholesky> cholesky_;
  std::optional<Snapshot> before_;
  bool is_damped_ = false;  ///< whether its last step was
};

}  // namespace

WindowUpdate updateWindow(Window& window, const Prior& prior, const FactorBuilder& factors,
                          const SolveLimits& limits, const LandmarkLinearizationCache& frozen) {
  QuickTerms terms(window, prior, factors, frozen);
  WindowUpdate update;
  update.summary = minimize(terms, limits);
  update.covariance = terms.covariance();
  update.errors_sigmas = terms.errors();
  return update;
}

}  // namespace lodeline
