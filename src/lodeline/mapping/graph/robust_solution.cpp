#include "lodeline/mapping/graph/robust_solution.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <set>

#include "lodeline/mapping/graph/loop_gate.h"
#include "lodeline/mapping/graph/robust/loop_support.h"
#include "lodeline/mapping/graph/robust/robust_weights.h"

namespace lodeline {
namespace {

/// Steps of one round of the graduation. The next round continues from there, so none has to converge.
constexpr int kGraduationIterations = 3;
constexpr int kMostRounds = 40;
/// Solutions of the truncated cost after the graduation, until no factor changes sides.
constexpr int kMostFinalRounds = 10;
/// Least support in a batch, relative to its largest.
constexpr double kSupportOfBatch = 0.75;
/// Probability that a false loop has so many neighbours and passes so wide a gate, above which both are no
/// evidence.
constexpr double kMostByAccident = 1e-3;
/// Rounds in which refused loops are tried again.
constexpr int kMostTrials = 5;

std::ptrdiff_t agreeing(const ReportedFactor& loop, bool is_used) {
  return std::count_if(loop.agreeing.begin(), loop.agreeing.end(),
                       [&](const ReportedFactor* other) { return other->isUsed() == is_used; });
}

Loop loopOf(const ReportedFactor& factor) {
  Loop loop;
  loop.old_keyframe = factor.from;
  loop.new_keyframe = factor.to;
  loop.old_from_new = factor.relative.from_from_to;
  loop.covariance = factor.relative.covariance;
  return loop;
}

}  // namespace

RobustSolution::RobustSolution(GraphProblem* problem, const PoseGraphOptions& options, GraphSummary* summary)
    : problem_(problem), options_(options), summary_(summary) {}

void RobustSolution::run(bool was_solved) {
  findNeighbours();
  if (!was_solved || !extend()) rebuild();
  for (ReportedFactor& factor : problem_->reported()) factor.is_new = false;
}

void RobustSolution::findNeighbours() {
  Factors factors;
  std::vector<Loop> loops;
  size_t first_new = 0;
  for (ReportedFactor& factor : problem_->reported()) {
    if (!factor.isLoop()) continue;
    factors.push_back(&factor);
    loops.push_back(loopOf(factor));
    if (!factor.is_new) first_new = factors.size();
  }
  if (first_new == factors.size()) return;
  std::unique_ptr<GraphCovariance> covariance;
  const auto between_singles = [&](KeyframeId from, KeyframeId to) {
    if (!covariance) covariance = std::make_unique<GraphCovariance>(problem_->factorization());
    return covariance->relative(from, to);
  };
  const double limit = chiSquaredQuantile(options_.inlier_probability, 6);
  for (const LoopPair& pair :
       neighbouringLoops(loops, first_new, problem_->chains(), between_singles, limit)) {
    ReportedFactor *a = factors[pair.a], *b = factors[pair.b];
    if (pair.agree) {
      a->agreeing.push_back(b);
      b->agreeing.push_back(a);
    } else {
      ++a->disagreeing;
      ++b->disagreeing;
    }
  }
}

bool RobustSolution::extend() {
  Factors needed = robust(true), added;
  for (ReportedFactor& factor : problem_->reported()) {
    if (!factor.is_robust || !factor.is_new) continue;
    added.push_back(&factor);
    if (!factor.isLoop()) problem_->setWeight(&factor, 1.0);
  }
  needed.insert(needed.end(), added.begin(), added.end());
  leastSquares(options_.most_iterations);
  Factors untried = refusedLoops();
  std::erase_if(untried, [](const ReportedFactor* loop) { return loop->is_doubtful; });
  admit(untried);
  settle();
  const Factors weak = weaklySupported(accidentalAgreement());
  return std::all_of(needed.begin(), needed.end(),
                     [](const ReportedFactor* factor) { return factor->isUsed(); }) &&
         std::none_of(weak.begin(), weak.end(), [](const ReportedFactor* loop) { return loop->is_new; });
}

void RobustSolution::rebuild() {
  for (ReportedFactor* factor : robust(true)) problem_->setWeight(factor, 0.0);
  for (ReportedFactor& factor : problem_->reported()) factor.is_doubtful = false;
  problem_->restoreChains();
  leastSquares(options_.most_iterations);
  takeInBatches();
  bool has_control = false;
  for (ReportedFactor* factor : robust(false)) {
    if (factor->isLoop()) continue;
    problem_->setWeight(factor, 1.0);
    has_control = true;
  }
  if (has_control) settle();
  tryRefused();
  reconsiderSupported();
  takeOutDoubtful();
}

void RobustSolution::takeInBatches() {
  std::map<int, Factors> by_support;
  for (ReportedFactor* loop : refusedLoops()) {
    by_support[std::max(0, static_cast<int>(loop->agreeing.size()) - loop->disagreeing)].push_back(loop);
  }
  while (!by_support.empty()) {
    const double least = kSupportOfBatch * by_support.rbegin()->first;
    Factors batch;
    while (!by_support.empty() && by_support.rbegin()->first >= least) {
      const Factors& loops = by_support.rbegin()->second;
      batch.insert(batch.end(), loops.begin(), loops.end());
      by_support.erase(std::prev(by_support.end()));
    }
    if (admit(batch) > 0) settle();
  }
}

void RobustSolution::tryRefused() {
  for (int trial = 0; trial < kMostTrials; ++trial) {
    Factors loops = refusedLoops();
    std::erase_if(loops, [](const ReportedFactor* loop) { return loop->is_doubtful; });
    if (admit(loops) == 0) return;
    settle();
  }
}

double RobustSolution::truncatedCost() const {
  double cost = 2.0 * summary_->cost;
  for (const ReportedFactor* factor : robust(false)) cost += limitOf(*factor);
  return cost;
}

void RobustSolution::reconsiderSupported() {
  const AccidentalAgreement accidental = accidentalAgreement();
  Factors supported = refusedLoops();
  std::erase_if(supported,
                [&](const ReportedFactor* loop) { return accidental.share(agreeing(*loop, true)) > 0.0; });
  if (supported.empty()) return;
  const Factors used = robust(true);
  const double cost = truncatedCost();
  for (ReportedFactor* loop : supported) problem_->setWeight(loop, 1.0);
  settle();
  if (truncatedCost() < cost) return tryRefused();
  for (ReportedFactor* factor : robust(true)) problem_->setWeight(factor, 0.0);
  for (ReportedFactor* factor : used) problem_->setWeight(factor, 1.0);
  leastSquares(options_.most_iterations);
}

AccidentalAgreement RobustSolution::accidentalAgreement() const {
  std::vector<std::ptrdiff_t> counts;
  for (const ReportedFactor* loop : refusedLoops()) counts.push_back(agreeing(*loop, false));
  return AccidentalAgreement(std::move(counts));
}

RobustSolution::Factors RobustSolution::weaklySupported(const AccidentalAgreement& accidental) const {
  Factors weak = robust(true);
  std::erase_if(weak, [&](const ReportedFactor* loop) {
    return !loop->isLoop() || accidental.share(agreeing(*loop, true)) == 0.0;
  });
  return weak;
}

void RobustSolution::takeOutDoubtful() {
  const AccidentalAgreement accidental = accidentalAgreement();
  const Factors weak = weaklySupported(accidental);
  if (weak.empty()) return;
  for (ReportedFactor* loop : weak) {
    problem_->setWeight(loop, 0.0);
    loop->is_doubtful = true;
  }
  leastSquares(options_.most_iterations);
  for (int trial = 0; trial < kMostTrials; ++trial) {
    if (!admitCertain(accidental)) return;
    settle();
  }
}

bool RobustSolution::admitCertain(const AccidentalAgreement& accidental) {
  LoopGate gate(problem_, chiSquaredQuantile(options_.inlier_probability, 6));
  const Factors refused = refusedLoops(), passed = gate.passed(refused);
  const std::set<const ReportedFactor*> inside(passed.begin(), passed.end());
  std::vector<Vec6> residuals;
  for (const ReportedFactor* loop : refused) {
    if (inside.count(loop) == 0) residuals.emplace_back(loop->residual());
  }
  Factors certain;
  for (ReportedFactor* loop : passed) {
    const double by_accident = accidental.share(agreeing(*loop, true));
    loop->is_doubtful = by_accident * gate.shareThatPasses(*loop, residuals) > kMostByAccident;
    if (!loop->is_doubtful) certain.push_back(loop);
  }
  for (ReportedFactor* loop : certain) problem_->setWeight(loop, 1.0);
  return !certain.empty();
}

int RobustSolution::admit(const Factors& candidates) {
  if (candidates.empty()) return 0;
  LoopGate gate(problem_, chiSquaredQuantile(options_.inlier_probability, 6));
  const Factors passed = gate.passed(candidates);
  for (ReportedFactor* loop : passed) problem_->setWeight(loop, 1.0);
  return static_cast<int>(passed.size());
}

void RobustSolution::settle() {
  const Factors used = robust(true);
  leastSquares(options_.most_iterations);
  const std::vector<double> first = ratiosOf(used);
  if (std::all_of(first.begin(), first.end(), [](double ratio) { return ratio <= 1.0; })) return;
  GraduatedWeights graduation(first);
  for (int round = 0; round < kMostRounds && !graduation.areBinary(); ++round) {
    const std::vector<double> weights = graduation.next(ratiosOf(used));
    for (size_t i = 0; i < used.size(); ++i) problem_->setWeight(used[i], weights[i]);
    leastSquares(kGraduationIterations);
  }
  for (int round = 0; round < kMostFinalRounds && truncate(used); ++round) {
    leastSquares(options_.most_iterations);
  }
}

bool RobustSolution::truncate(const Factors& factors) {
  const std::vector<double> ratios = ratiosOf(factors);
  bool is_changed = false;
  for (size_t i = 0; i < factors.size(); ++i) {
    const double weight = ratios[i] <= 1.0 ? 1.0 : 0.0;
    is_changed = is_changed || factors[i]->loss.weight != weight;
    problem_->setWeight(factors[i], weight);
  }
  return is_changed;
}

double RobustSolution::limitOf(const ReportedFactor& factor) const {
  return chiSquaredQuantile(options_.inlier_probability, factor.degrees_of_freedom);
}

std::vector<double> RobustSolution::ratiosOf(const Factors& factors) const {
  std::vector<double> ratios;
  for (const ReportedFactor* factor : factors)
    ratios.push_back(problem_->chiSquared(*factor) / limitOf(*factor));
  return ratios;
}

RobustSolution::Factors RobustSolution::robust(bool is_used) const {
  Factors factors;
  for (ReportedFactor& factor : problem_->reported()) {
    if (factor.is_robust && factor.isUsed() == is_used) factors.push_back(&factor);
  }
  return factors;
}

RobustSolution::Factors RobustSolution::refusedLoops() const {
  Factors loops = robust(false);
  std::erase_if(loops, [](const ReportedFactor* factor) { return !factor->isLoop(); });
  return loops;
}

void RobustSolution::leastSquares(int most_iterations) {
  const ceres::Solver::Summary solution = problem_->solve(most_iterations);
  summary_->rounds += 1;
  summary_->iterations += static_cast<int>(solution.iterations.size()) - 1;
  summary_->cost = solution.final_cost;
  summary_->converged = solution.termination_type == ceres::CONVERGENCE;
}

}  // namespace lodeline
