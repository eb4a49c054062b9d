#include "lodeline/batch/refine.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodeline/batch/batch_problem.h"
#include "lodeline/batch/refined_frames.h"
#include "lodeline/estimator/solver/levenberg_marquardt.h"
#include "lodeline/problem/marginalization/landmark_host.h"
#include "lodeline/problem/state/inertial_states.h"
#include "lodeline/util/thread_clock.h"

namespace lodeline {
namespace {

/// The batch problem as minimize() wants it. The matrix is factorized in place, and so computed again for
/// every damping.
class BatchSteps {
 public:
  BatchSteps(BatchProblem& problem, BlockSkylineCholesky& hessian) : problem_(problem), hessian_(hessian) {}
  double cost() { return problem_.cost(); }
  void linearize() { before_ = problem_.values(); }
  bool step(double damping) {
    Eigen::VectorXd gradient;
    problem_.linearize(&hessian_, &gradient);
    hessian_.damp(damping);
    if (!hessian_.factorize()) return false;
    problem_.step(hessian_.solve(-gradient));
    return true;
  }
  void restore() { problem_.setValues(before_); }

 private:
  BatchProblem& problem_;
  BlockSkylineCholesky& hessian_;
  std::vector<double> before_;
};

/// Factors on the sigmas of loop observations in each round (joinLandmarks()). At 450 px per radian and
/// points within half a pixel, the first one lets a loop pass that is open by 0.25 rad. Each round
/// leaves less than a quarter of that.
std::vector<double> looseningsOf(const LoopClosures& loops, const RefinementOptions& wanted) {
  std::vector<double> loosenings;
  if (!loops.observations.empty()) loosenings = {64.0, 16.0, 4.0};
  loosenings.insert(loosenings.end(), static_cast<size_t>(std::max(wanted.rounds, 0)), 1.0);
  return loosenings;
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

/// Covariances of the stated model at the solution. `errors`: of the states along the path, with
/// loops; replaced by the part that loops remove.
BatchCovariances posteriorCovariances(BatchProblem& problem, BlockSkylineCholesky& hessian,
                                      StateErrors* errors) {
  Eigen::VectorXd gradient;
  problem.linearize(&hessian, &gradient);
  if (!hessian.factorize()) return {};
  if (!errors->empty()) *errors = errorsRemovedByLoops(problem, *errors, hessian);
  hessian.invert();
  return covariancesOf(problem, hessian);
}

/// The same without the information that the estimate uses and the reported covariance leaves out. They must
/// also include errors that all tracks have in common, such as those of intrinsics or a port.
BatchCovariances reportedCovariances(BatchProblem& problem, const RefinementSummary& summary,
                                     BlockSkylineCholesky& hessian) {
  Eigen::VectorXd gradient;
  problem.weighObservations(std::max(1.0, summary.design_effect / summary.observation_variance));
  problem.linearize(&hessian, &gradient);
  problem.subtractRemoved(&hessian);
  if (!hessian.factorize()) return {};
  hessian.invert();
  return covariancesOf(problem, hessian);
}

}  // namespace

Refinement refine(const Rig& rig, const EstimatorOptions& options, const EstimatorLog& record,
                  const RefinementOptions& wanted) {
  return refine(rig, options, record, LoopClosures(), wanted);
}

Refinement refine(const Rig& rig, const EstimatorOptions& of_run, const EstimatorLog& record,
                  const LoopClosures& loops, const RefinementOptions& wanted) {
  const EstimatorOptions options = optionsFor(rig, of_run);
  const double start_s = processSeconds();
  Refinement result;
  RefinementSummary& summary = result.summary;
  result.frames = record.frames();
  if (record.states().size() < 2) {
    summary.refusal = "fewer than two frames have a pose";
    return result;
  }
  const std::vector<double> loosenings = looseningsOf(loops, wanted);
  BatchProblem problem(rig, options, record, loops, loosenings.empty() ? 1.0 : loosenings.front());
  summary.states = static_cast<int>(problem.states());
  summary.loop_links = problem.links();
  for (size_t i = 0; i < loosenings.size(); ++i) {
    // The covariances take about as long as a round.
    if (wanted.progress) wanted.progress(static_cast<double>(i) / static_cast<double>(loosenings.size() + 1));
    if (i > 0) {
      // Statistics of a solution, because the pose errors of the run are correlated over time as well.
      const TimeCorrelatedErrors lasting = problem.timeCorrelatedErrors();
      summary.design_effect = lasting.designEffect();
      summary.observation_variance = lasting.variance();
      problem.resetLinearizationPoints();
      problem.tightenLoops(loosenings[i]);
      summary.outlier_share = problem.renewLandmarks();
      problem.weighObservations(summary.observation_variance);
    }
    // Each round but the last ends when its accuracy suffices for the next round's landmarks and weights.
    const double relative_gain = i + 1 == loosenings.size() ? 0.0 : 1e-4;
    BlockSkylineCholesky hessian = problem.emptyMatrix();
    BatchSteps steps(problem, hessian);
    const SolveSummary round = minimize(steps, {wanted.max_iterations, relative_gain, wanted.gain_tolerance});
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
  summary.loop_links_used = problem.linksUsed();
  BatchCovariances posterior, reported;
  StateErrors removed;
  BlockSkylineCholesky hessian = problem.emptyMatrix();
  if (static_cast<double>(hessian.bytes()) < 1e6 * wanted.max_covariance_MB) {
    if (problem.linksUsed() > 0) removed = errorsAlongPath(problem, rig, options, record);
    posterior = posteriorCovariances(problem, hessian, &removed);
    reported = reportedCovariances(problem, summary, hessian);
  }
  summary.has_covariance = !reported.empty();
  result.frames = refinedFrames(problem, rig, options, record, posterior, reported, removed);
  result.landmarks = mapPoints(problem);
  const std::optional<CameraCorrections>& cameras = result.frames.back().camera_corrections;
  if (cameras && !cameras->ports.empty()) summary.camera_corrections = cameras;
  measureMoves(record.frames(), result.frames, &summary);
  summary.processor_s = processSeconds() - start_s;
  return result;
}

}  // namespace lodeline
