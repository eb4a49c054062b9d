#include "lodeline/mapping/graph/pose_graph.h"

#include <fmt/format.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/graph/graph_problem.h"
#include "lodeline/mapping/graph/robust/robust_weights.h"

namespace lodeline {
namespace {

/// Steps of one round of the graduation. The next round continues from there, so none has to converge.
constexpr int kGraduationIterations = 4;
/// With a largest ratio of 1e9 the weights are binary after 80 rounds.
constexpr int kMostRounds = 120;
/// Solutions of the truncated cost after the graduation, until no factor changes sides.
constexpr int kMostFinalRounds = 10;

std::vector<ReportedFactor*> robustFactors(GraphProblem* problem) {
  std::vector<ReportedFactor*> robust;
  for (ReportedFactor& factor : problem->reported()) {
    if (factor.is_robust) robust.push_back(&factor);
  }
  return robust;
}

/// chi^2 of each factor relative to the limit of its degrees of freedom.
std::vector<double> ratiosOf(const std::vector<ReportedFactor*>& factors, double probability,
                             GraphProblem* problem) {
  const double limit_3 = chiSquaredQuantile(probability, 3), limit_6 = chiSquaredQuantile(probability, 6);
  std::vector<double> ratios;
  for (const ReportedFactor* factor : factors) {
    ratios.push_back(problem->chiSquared(*factor) / (factor->degrees_of_freedom == 3 ? limit_3 : limit_6));
  }
  return ratios;
}

/// Sets the weights of the truncated cost, 0 or 1. Whether they were so before.
bool truncate(const std::vector<double>& ratios, const std::vector<ReportedFactor*>& factors) {
  bool is_same = true;
  for (size_t i = 0; i < factors.size(); ++i) {
    const double weight = ratios[i] <= 1.0 ? 1.0 : 0.0;
    is_same = is_same && factors[i]->loss.weight == weight;
    factors[i]->loss.weight = weight;
  }
  return is_same;
}

FactorReport reportOf(const ReportedFactor& factor, double probability, GraphProblem* problem) {
  FactorReport report{factor.kind,
                      factor.name,
                      factor.from,
                      factor.to,
                      factor.is_robust,
                      factor.loss.weight,
                      problem->chiSquared(factor),
                      factor.degrees_of_freedom,
                      factor.residual(),
                      true,
                      ""};
  const double limit = chiSquaredQuantile(probability, factor.degrees_of_freedom);
  report.accepted = !factor.is_robust || factor.loss.weight > 0.5;
  if (!report.accepted) {
    report.reason = fmt::format(
        "contradicts the rest of the graph: chi^2 {:.1f}, at most {:.1f} with {} "
        "degrees of freedom",
        report.chi_squared, limit, factor.degrees_of_freedom);
  }
  return report;
}

}  // namespace

void PoseGraphOptions::check() const {
  chiSquaredQuantile(inlier_probability, 6);
  if (most_iterations < 1) throw UsageError("a pose graph needs at least one iteration");
}

PoseGraph::PoseGraph(const PoseGraphOptions& options)
    : options_(options), problem_(std::make_unique<GraphProblem>()) {
  options_.check();
}
PoseGraph::~PoseGraph() = default;
PoseGraph::PoseGraph(PoseGraph&&) noexcept = default;
PoseGraph& PoseGraph::operator=(PoseGraph&&) noexcept = default;

void PoseGraph::addNode(KeyframeId id, int dive, const Rigid3& pose) { problem_->addNode(id, dive, pose); }
void PoseGraph::add(const GraphEdge& edge) { problem_->add(edge); }
void PoseGraph::add(const TiltMeasurement& measurement) { problem_->add(measurement); }
void PoseGraph::add(const HeadingMeasurement& measurement) { problem_->add(measurement); }
void PoseGraph::add(const HeightMeasurement& measurement) { problem_->add(measurement); }
void PoseGraph::add(const PositionMeasurement& measurement) { problem_->add(measurement); }
void PoseGraph::add(const GraphLandmark& landmark) { problem_->add(landmark); }
void PoseGraph::add(const Sighting& sighting) { problem_->add(sighting); }
void PoseGraph::add(const AzimuthPrior& prior) { problem_->add(prior); }
void PoseGraph::add(const HeightOffsetPrior& prior) { problem_->add(prior); }

GraphSummary PoseGraph::solve() {
  GraphSummary summary;
  if (size() == 0) {
    summary.converged = true;
    return summary;
  }
  problem_->hold();
  const std::vector<ReportedFactor*> robust = robustFactors(problem_.get());
  leastSquares(options_.most_iterations, &summary);
  const std::vector<double> ratios = ratiosOf(robust, options_.inlier_probability, problem_.get());
  bool is_settled = true;
  for (size_t i = 0; i < robust.size(); ++i) {
    is_settled = is_settled && (ratios[i] <= 1.0) == (robust[i]->loss.weight == 1.0);
  }
  if (!is_settled) graduate(&summary);
  for (const ReportedFactor& factor : problem_->reported()) {
    summary.factors.push_back(reportOf(factor, options_.inlier_probability, problem_.get()));
  }
  return summary;
}

void PoseGraph::graduate(GraphSummary* summary) {
  const std::vector<ReportedFactor*> robust = robustFactors(problem_.get());
  const auto ratios = [&] { return ratiosOf(robust, options_.inlier_probability, problem_.get()); };
  for (ReportedFactor* factor : robust) factor->loss.weight = 1.0;
  leastSquares(options_.most_iterations, summary);
  GraduatedWeights graduation(ratios());
  for (int round = 0; round < kMostRounds && !graduation.areBinary(); ++round) {
    const std::vector<double> weights = graduation.next(ratios());
    for (size_t i = 0; i < robust.size(); ++i) robust[i]->loss.weight = weights[i];
    leastSquares(kGraduationIterations, summary);
  }
  for (int round = 0; round < kMostFinalRounds; ++round) {
    const bool is_same = truncate(ratios(), robust);
    leastSquares(options_.most_iterations, summary);
    if (is_same) break;
  }
}

void PoseGraph::leastSquares(int most_iterations, GraphSummary* summary) {
  const ceres::Solver::Summary solution = problem_->solve(most_iterations);
  summary->rounds += 1;
  summary->iterations += static_cast<int>(solution.iterations.size()) - 1;
  summary->cost = solution.final_cost;
  summary->converged = solution.termination_type == ceres::CONVERGENCE;
}

bool PoseGraph::contains(KeyframeId id) const { return problem_->contains(id); }
size_t PoseGraph::size() const { return problem_->size(); }
Rigid3 PoseGraph::pose(KeyframeId id) const { return problem_->pose(id); }
std::map<KeyframeId, Rigid3> PoseGraph::poses() const { return problem_->poses(); }
Vec3 PoseGraph::landmark(const std::string& name) const { return problem_->landmark(name); }
double PoseGraph::azimuth(int dive) const { return problem_->azimuth(dive); }
double PoseGraph::heightOffset(int dive) const { return problem_->heightOffset(dive); }
std::optional<double> PoseGraph::azimuthSigma(int dive) const { return problem_->azimuthSigma(dive); }
bool PoseGraph::hasHeightOffset(int dive) const { return problem_->hasHeightOffset(dive); }
GraphCovariance PoseGraph::covariance() const { return GraphCovariance(problem_->factorization()); }

}  // namespace lodeline
