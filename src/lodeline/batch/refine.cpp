#include "lodeline/batch/refine.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "lodeline/batch/batch_problem.h"
#include "lodeline/batch/refined_frames.h"
#include "lodeline/estimator/state/inertial_states.h"
#include "lodeline/estimator/visual/landmark_host.h"
#include "lodeline/util/thread_clock.h"

namespace lodeline {
namespace {

/// One round of Levenberg-Marquardt steps.
struct Round {
  int iterations = 0;
  double initial_cost = 0.0, final_cost = 0.0;
  bool converged = false;
};

/// Applies a step that reduces the cost and returns the new cost; empty where no damping gives such a step.
/// `damping` is adapted.
std::optional<double> lowerCost(BatchProblem& problem, double cost, BlockSkylineCholesky* hessian,
                                double* damping) {
  constexpr double kLeastDamping = 1e-12, kMostDamping = 1e1;
  const std::vector<double> before = problem.values();
  Eigen::VectorXd gradient;
  while (*damping <= kMostDamping) {
    problem.linearize(hessian, &gradient);
    hessian->damp(*damping);
    if (hessian->factorize()) {
      problem.step(hessian->solve(-gradient));
      const double lowered = problem.cost();
      if (lowered < cost) {
        *damping = std::max(kLeastDamping, 0.05 * *damping);
        return lowered;
      }
      problem.setValues(before);
    }
    *damping *= 30.0;
  }
  return std::nullopt;
}

/// Iterates until convergence if `is_last`, else until the accuracy suffices for the next round's landmarks
/// and weights.
Round solve(BatchProblem& problem, const RefinementOptions& wanted, bool is_last,
            BlockSkylineCholesky* hessian) {
  constexpr double kRoughGain = 1e-4;  // relative to the cost
  Round round;
  double damping = 1e-7;
  double cost = round.initial_cost = problem.cost();
  while (round.iterations < wanted.max_iterations && !round.converged) {
    ++round.iterations;
    const std::optional<double> lowered = lowerCost(problem, cost, hessian, &damping);
    const double least_gain =
        is_last ? wanted.gain_tolerance : std::max(wanted.gain_tolerance, kRoughGain * cost);
    round.converged = !lowered || cost - *lowered < least_gain;
    cost = lowered.value_or(cost);
  }
  round.final_cost = cost;
  return round;
}

void measureMoves(const std::vector<FrameEstimate>& before, const std::vector<FrameEstimate>& after,
                  RefinementSummary* summary) {
  double squares_m2 = 0.0, squares_rad2 = 0.0;
  for (size_t i = 0; i < before.size(); ++i) {
    const Eigen::Matrix<double, 6, 1> moved =
        perturbationBetween(before[i].state.world_from_body, after[i].state.world_from_body);
    squares_m2 += moved.head<3>().squaredNorm();
    squares_rad2 += moved.tail<3>().squaredNorm();
    summary->moved_max_m = std::max(summary->moved_max_m, moved.head<3>().norm());
  }
  const auto count = static_cast<double>(before.size());
  summary->moved_rms_m = std::sqrt(squares_m2 / count);
  summary->turned_rms_rad = std::sqrt(squares_rad2 / count);
  summary->forward_sigma_m = std::sqrt(before.back().covariance.topLeftCorner<3, 3>().trace());
  summary->sigma_m = std::sqrt(after.back().covariance.topLeftCorner<3, 3>().trace());
}

std::vector<MapPoint> mapPoints(const BatchProblem& problem) {
  std::vector<MapPoint> points;
  for (const auto& [id, track] : problem.window().tracks()) {
    if (!track.landmark) continue;
    if (const auto point = mapPointOf(problem.window(), id, track, problem.factors()))
      points.push_back(*point);
  }
  return points;
}

std::string refusalOf(const RefinementSummary& summary, const RefinementOptions& wanted) {
  if (!std::isfinite(summary.cost)) return "its cost is not finite";
  if (summary.outlier_share > wanted.max_outlier_share) {
    return fmt::format("{:.0f} % of the observations contradict it, of {:.0f} % allowed",
                       100.0 * summary.outlier_share, 100.0 * wanted.max_outlier_share);
  }
  return {};
}

}  // namespace

Refinement refine(const Rig& rig, const EstimatorOptions& of_run, const EstimatorLog& record,
                  const RefinementOptions& wanted) {
  const EstimatorOptions options = optionsFor(rig, of_run);
  const double start_s = processSeconds();
  Refinement result;
  RefinementSummary& summary = result.summary;
  result.frames = record.frames();
  if (record.states().size() < 2) {
    summary.refusal = "fewer than two frames have a pose";
    return result;
  }
  BatchProblem problem(rig, options, record);
  BlockSkylineCholesky hessian = problem.emptyMatrix();
  summary.states = static_cast<int>(problem.states());
  for (int i = 0; i < wanted.rounds; ++i) {
    if (i > 0) {
      // Statistics of a solution, because the pose errors of the run are correlated over time as well.
      const TimeCorrelatedErrors lasting = problem.timeCorrelatedErrors();
      summary.design_effect = lasting.designEffect();
      summary.observation_variance = lasting.variance();
      problem.resetLinearizationPoints();
      summary.outlier_share = problem.renewLandmarks();
      problem.weighObservations(summary.observation_variance);
    }
    const Round round = solve(problem, wanted, i + 1 == wanted.rounds, &hessian);
    if (i == 0) {
      summary.forward_cost = round.initial_cost;
      summary.first_round_cost = round.final_cost;
    }
    summary.cost = round.final_cost;
    summary.iterations += round.iterations;
    summary.converged = round.converged;
  }
  summary.landmarks = static_cast<int64_t>(problem.landmarks());
  summary.observations = static_cast<int64_t>(problem.observations());
  summary.refusal = refusalOf(summary, wanted);
  if (!summary.usable()) return result;
  if (static_cast<double>(hessian.bytes()) < 1e6 * wanted.max_covariance_MB) {
    Eigen::VectorXd gradient;
    // The reported covariance must also include errors that all tracks have in common, such as those of
    // intrinsics or a port.
    problem.weighObservations(std::max(1.0, summary.design_effect / summary.observation_variance));
    problem.linearize(&hessian, &gradient);
    problem.subtractRemoved(&hessian);
    summary.has_covariance = hessian.factorize();
    if (summary.has_covariance) hessian.invert();
  }
  result.frames = refinedFrames(problem, rig, options, record, summary.has_covariance ? &hessian : nullptr);
  result.landmarks = mapPoints(problem);
  measureMoves(record.frames(), result.frames, &summary);
  summary.processor_s = processSeconds() - start_s;
  return result;
}

}  // namespace lodeline
