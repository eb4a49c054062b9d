#include "lodeline/mapping/cloud/shape_solver.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "lodeline/geometry/so3.h"
#include "lodeline/geometry/squared.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr double kCapture_m = 0.5;
constexpr int kFullSteps = 12;
/// A tenth of the least sigmas of a result.
constexpr double kStill_m = 1e-3;
constexpr double kStill_rad = 3e-4;
constexpr size_t kLeastRows = 30;
/// Points in one metre of wall, whose errors are alike: a row counts as the inverse of an observation.
constexpr double kRowsPerObservation = 5.0;

double scoreOf(const std::vector<ShapeRow>& rows) {
  double sum = 0.0;
  for (const ShapeRow& row : rows) sum += std::min(squared(row.error), 9.0);
  return sum / static_cast<double>(rows.size());
}

/// Median of the rows' sigmas, m.
double usualSigma(const std::vector<ShapeRow>& rows) {
  std::vector<double> sigmas;
  for (const ShapeRow& row : rows) sigmas.push_back(1.0 / row.jacobian[4]);
  return median(std::move(sigmas));
}

Vec5 stepOf(const ShapeProblem& problem, const ShapePrior& prior, const ShapeState& state,
            const std::vector<ShapeRow>& rows, double width) {
  Mat5 hessian = Mat5::Zero();
  Vec5 gradient = Vec5::Zero();
  for (const ShapeRow& row : rows) {
    const double weight = shapeWeight(row.error, width) / kRowsPerObservation;
    hessian += weight * row.jacobian * row.jacobian.transpose();
    gradient += weight * row.error * row.jacobian;
  }
  const Mat4 information = prior.covariance.inverse();
  hessian.topLeftCorner<4, 4>() += information;
  gradient.head<4>() += information * problem.difference(prior.old_from_new, state.old_from_new);
  hessian(4, 4) += 1.0 / squared(kOffsetSigma_m);
  gradient[4] += state.offset_m / squared(kOffsetSigma_m);
  Vec5 step = -hessian.ldlt().solve(gradient);
  // Counterparts change along the way: a step stays within what they are good for.
  const double size = std::max(step.head<3>().norm() / 0.3, std::abs(step[3]) / 0.1);
  return size > 1.0 ? Vec5(step / size) : step;
}

}  // namespace

double shapeWeight(double error, double width) { return 1.0 / squared(1.0 + squared(error / width)); }

ShapeFit fitShape(const ShapeProblem& problem, const ShapePrior& prior, const ShapeState& start,
                  double start_width_m, size_t stride, int most_iterations) {
  ShapeFit fit;
  fit.state = start;
  double width = -1.0;
  for (int i = 0; i < most_iterations; ++i) {
    const auto rows = problem.rows(fit.state, stride);
    if (rows.size() < kLeastRows) return fit;
    width = std::max(kShapeLossWidth, width < 0.0 ? start_width_m / usualSigma(rows) : 0.7 * width);
    Vec5 step = stepOf(problem, prior, fit.state, rows, width);
    // Counterparts that change to and fro would keep full steps from ending.
    if (i >= kFullSteps) step *= 0.5;
    fit.state = problem.moved(fit.state, step);
    if (width == kShapeLossWidth && step.head<3>().norm() < kStill_m && std::abs(step[3]) < kStill_rad) {
      fit.converged = true;
      break;
    }
  }
  const auto rows = problem.rows(fit.state, stride);
  if (rows.size() < kLeastRows) return fit;
  fit.score = scoreOf(rows);
  fit.counterpart_share = static_cast<double>(rows.size() * stride) / static_cast<double>(problem.size());
  return fit;
}

std::vector<ShapeState> startsOf(const ShapeProblem& problem, const ShapePrior& prior, double spacing_m,
                                 size_t most) {
  const Mat32 axes = tangentBasis(problem.oldCloud().up_F);
  const Mat2 horizontal = axes.transpose() * prior.covariance.topLeftCorner<3, 3>() * axes;
  const Eigen::SelfAdjointEigenSolver<Mat2> solver(horizontal);
  const Vec2 sigmas = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  Eigen::Array2i counts;
  for (int i = 0; i < 2; ++i)
    counts[i] = static_cast<int>(std::ceil(std::max(0.0, 2.5 * sigmas[i] - 0.5 * spacing_m) / spacing_m));
  if (static_cast<double>(2 * counts[0] + 1) * (2 * counts[1] + 1) > static_cast<double>(most)) return {};
  // Conditional mean of all parameters, given the horizontal displacement.
  const Eigen::Matrix<double, 4, 2> regression =
      prior.covariance.leftCols<3>() * axes * (horizontal + 1e-10 * Mat2::Identity()).inverse();
  std::vector<ShapeState> starts;
  for (int a = -counts[0]; a <= counts[0]; ++a) {
    for (int b = -counts[1]; b <= counts[1]; ++b) {
      Vec5 step = Vec5::Zero();
      step.head<4>() = regression * (solver.eigenvectors() * Vec2(a * spacing_m, b * spacing_m));
      starts.push_back(problem.moved({prior.old_from_new, 0.0}, step));
    }
  }
  return starts;
}

std::vector<ShapeFit> minimaOf(const ShapeProblem& problem, const ShapePrior& prior,
                               const std::vector<ShapeState>& starts) {
  constexpr int kCoarseIterations = 15, kFineIterations = 30;
  constexpr size_t kMostMinima = 5;
  constexpr double kHopeless = 2.0;  // times the lowest score: no rival, however well it is refined
  const auto is_better = [](const ShapeFit& a, const ShapeFit& b) { return a.score < b.score; };
  const auto keep_different = [&](std::vector<ShapeFit>& fits, double apart_m) {
    std::stable_sort(fits.begin(), fits.end(), is_better);
    std::vector<ShapeFit> different;
    for (const ShapeFit& fit : fits) {
      const bool is_known = std::any_of(different.begin(), different.end(), [&](const ShapeFit& other) {
        const Vec4 gap = problem.difference(other.state.old_from_new, fit.state.old_from_new);
        return gap.head<3>().norm() < apart_m && std::abs(gap[3]) < 0.05;
      });
      const bool is_hopeless = fit.score > kHopeless * fits.front().score;
      if (!is_known && !is_hopeless && different.size() < kMostMinima && fit.score < 1e9)
        different.push_back(fit);
    }
    fits = std::move(different);
  };
  std::vector<ShapeFit> fits;
  for (const ShapeState& start : starts)
    fits.push_back(fitShape(problem, prior, start, kCapture_m, starts.size() > 1 ? 2 : 1, kCoarseIterations));
  keep_different(fits, 0.1);
  for (ShapeFit& fit : fits) fit = fitShape(problem, prior, fit.state, 0.0, 1, kFineIterations);
  keep_different(fits, 0.05);
  return fits;
}

}  // namespace lodeline
