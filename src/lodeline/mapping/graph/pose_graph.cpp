#include "lodeline/mapping/graph/pose_graph.h"

#include <fmt/format.h>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/graph/graph_problem.h"
#include "lodeline/mapping/graph/robust/robust_weights.h"
#include "lodeline/mapping/graph/robust_solution.h"

namespace lodeline {
namespace {

FactorReport reportOf(const ReportedFactor& factor, double probability, const GraphProblem& problem) {
  FactorReport report{factor.kind,
                      factor.name,
                      factor.from,
                      factor.to,
                      factor.is_robust,
                      factor.loss.weight,
                      problem.chiSquared(factor),
                      factor.degrees_of_freedom,
                      factor.residual(),
                      true,
                      ""};
  const double limit = chiSquaredQuantile(probability, factor.degrees_of_freedom);
  report.accepted = !factor.is_robust || factor.loss.weight > 0.5;
  if (report.accepted) return report;
  if (factor.is_doubtful) {
    report.reason =
        "too few loops agree with it where the prediction is as uncertain as false loops are wrong";
  } else {
    report.reason = fmt::format(
        "contradicts the rest of the graph: chi^2 {:.1f}, at most {:.1f} with {} degrees of freedom",
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
void PoseGraph::add(const LandmarkObservation& observation) { problem_->add(observation); }
void PoseGraph::add(const AzimuthPrior& prior) { problem_->add(prior); }
void PoseGraph::add(const OriginDepth& depth) { problem_->add(depth); }
void PoseGraph::add(const SurfaceHeight& surface) { problem_->add(surface); }

GraphSummary PoseGraph::solve() {
  GraphSummary summary;
  if (size() == 0) {
    summary.converged = true;
    return summary;
  }
  problem_->hold();
  RobustSolution(problem_.get(), options_, &summary).run(was_solved_);
  was_solved_ = true;
  for (const ReportedFactor& factor : problem_->reported()) {
    summary.factors.push_back(reportOf(factor, options_.inlier_probability, *problem_));
  }
  return summary;
}

bool PoseGraph::contains(KeyframeId id) const { return problem_->contains(id); }
size_t PoseGraph::size() const { return problem_->size(); }
Rigid3 PoseGraph::pose(KeyframeId id) const { return problem_->pose(id); }
std::map<KeyframeId, Rigid3> PoseGraph::poses() const { return problem_->poses(); }
Vec3 PoseGraph::landmark(const std::string& name) const { return problem_->landmark(name); }
double PoseGraph::azimuth(int dive) const { return problem_->azimuth(dive); }
double PoseGraph::heightOffset(int dive) const { return problem_->heightOffset(dive); }
double PoseGraph::surfaceHeight() const { return problem_->surfaceHeight(); }
std::optional<double> PoseGraph::azimuthSigma(int dive) const { return problem_->azimuthSigma(dive); }
std::optional<double> PoseGraph::originDepthSigma(int dive) const { return problem_->originDepthSigma(dive); }
GraphCovariance PoseGraph::covariance() const { return GraphCovariance(problem_->factorization()); }

}  // namespace lodeline
