#include "lodeline/mapping/graph/loop_gate.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace lodeline {
namespace {

/// Few residuals are at hand, so their density is taken from a gate of four times the radius.
constexpr double kWidening = 16.0;

}  // namespace

LoopGate::LoopGate(GraphProblem* problem, double limit) : problem_(problem), limit_(limit) {
  for (const GraphEdge& edge : problem->certainEdges()) paths_.add(edge.from, edge.to, edge.relative);
  for (const ReportedFactor& factor : problem->reported()) {
    if (factor.isLoop() && factor.isUsed()) paths_.add(factor.from, factor.to, factor.relative);
  }
}

std::vector<ReportedFactor*> LoopGate::passed(const std::vector<ReportedFactor*>& loops) {
  std::map<KeyframeId, std::vector<ReportedFactor*>> by_start;
  for (ReportedFactor* loop : loops) by_start[loop->from].push_back(loop);
  std::vector<ReportedFactor*> passed;
  for (const auto& [start, candidates] : by_start) {
    std::vector<KeyframeId> ends;
    for (const ReportedFactor* loop : candidates) ends.push_back(loop->to);
    const std::map<KeyframeId, Mat6> along_paths = paths_.from(start, ends);
    for (ReportedFactor* loop : candidates) {
      const auto found = along_paths.find(loop->to);
      loop->gate_chi_squared = chiSquared(*loop, found == along_paths.end() ? nullptr : &found->second);
      if (loop->gate_chi_squared <= limit_) passed.push_back(loop);
    }
  }
  return passed;
}

double LoopGate::chiSquared(const ReportedFactor& loop, const Mat6* along_path) {
  const Rigid3 predicted = problem_->pose(loop.from).inverse() * problem_->pose(loop.to);
  const auto with = [&](const Mat6& prediction) {
    return mahalanobisSquared(loop.relative.from_from_to, predicted, loop.relative.covariance + prediction);
  };
  const double most = with(Mat6::Zero());
  if (most <= limit_) return most;
  const double least = along_path ? with(*along_path) : 0.0;
  if (least > limit_) return least;
  return with(predictionOf(loop));
}

Mat6 LoopGate::predictionOf(const ReportedFactor& loop) {
  if (!covariance_) covariance_ = std::make_unique<GraphCovariance>(problem_->factorization());
  return covariance_->relative(loop.from, loop.to).covariance;
}

double LoopGate::shareThatPasses(const ReportedFactor& loop, const std::vector<Vec6>& residuals) {
  if (residuals.empty()) return 0.0;
  const Eigen::LLT<Mat6> factor(loop.relative.covariance + predictionOf(loop));
  const auto passing = std::count_if(residuals.begin(), residuals.end(), [&](const Vec6& residual) {
    return factor.matrixL().solve(residual).squaredNorm() <= kWidening * limit_;
  });
  return static_cast<double>(passing) / static_cast<double>(residuals.size());
}

}  // namespace lodeline
