#include "lodeline/mapping/cloud/shape_knowledge.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "lodeline/geometry/squared.h"
#include "lodeline/mapping/cloud/shape_solver.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

/// Rows that meet the same plane share its error. The plane has this part of a row's variance: the leverage
/// of a place among ten neighbours, about 0.3.
constexpr double kSharedVariance = 0.3;

/// Sums over the rows; the offset is eliminated.
struct ShapeSums {
  Mat4 hessian = Mat4::Zero();
  Mat4 noise = Mat4::Zero();
  Mat4 scores = Mat4::Zero();      ///< M
  Mat4 considered = Mat4::Zero();  ///< derivative of the gradient by parameters that are not estimated
  Vec4 gradient = Vec4::Zero();
};

struct CellSums {
  Vec4 score = Vec4::Zero();
  Vec4 slope = Vec4::Zero();
};

std::array<int, 3> cellOf(const Vec3& place) {
  return {static_cast<int>(std::floor(place.x())), static_cast<int>(std::floor(place.y())),
          static_cast<int>(std::floor(place.z()))};
}

/// How the offset follows the other parameters, per unit of a row's derivative by the offset.
Vec4 offsetSlope(const std::vector<ShapeRow>& rows) {
  double information = 1.0 / squared(kOffsetSigma_m);
  Vec4 coupling = Vec4::Zero();
  for (const ShapeRow& row : rows) {
    const double weight = shapeWeight(row.error, kShapeLossWidth);
    information += weight * squared(row.jacobian[4]);
    coupling += weight * row.jacobian[4] * row.jacobian.head<4>();
  }
  return coupling / information;
}

ShapeSums sumsOf(const ShapeProblem& problem, const ShapeState& state, const std::vector<ShapeRow>& rows) {
  const Vec4 offset_slope = offsetSlope(rows);
  ShapeSums sums;
  std::map<std::array<int, 3>, CellSums> cells;
  for (const ShapeRow& row : rows) {
    const double weight = shapeWeight(row.error, kShapeLossWidth);
    const Vec4 slope = row.jacobian.head<4>() - row.jacobian[4] * offset_slope;
    sums.hessian += weight * slope * slope.transpose();
    sums.noise += weight * row.slope_noise;
    sums.gradient += weight * row.error * slope;
    sums.considered += weight * slope * row.considered.transpose();
    CellSums& cell = cells[cellOf(state.old_from_new * problem.newCloud().points[row.point].position_F)];
    cell.score += weight * row.error * slope;
    cell.slope += weight * slope;
  }
  const double number = static_cast<double>(cells.size());
  for (const auto& [place, cell] : cells) {
    const Vec4 score = cell.score - sums.gradient / number;
    sums.scores += number / std::max(1.0, number - 4.0) * score * score.transpose() +
                   kSharedVariance * cell.slope * cell.slope.transpose();
  }
  return sums;
}

/// Mean distance from which the points of a cloud were seen, m.
double sightOf(const LocalCloud& cloud) {
  double sum = 0.0;
  for (const CloudPoint& point : cloud.points) sum += point.view_F.norm();
  return sum / std::max(1.0, static_cast<double>(cloud.points.size()));
}

double usualError(const std::vector<ShapeRow>& rows) {
  std::vector<double> errors;
  for (const ShapeRow& row : rows) errors.push_back(std::abs(row.error));
  return 1.4826 * median(std::move(errors));
}

}  // namespace

Eigen::VectorXd ShapeKnowledge::observedPart(const Vec4& difference) const {
  return (basis.leftCols(observed).transpose() * hessian) * difference;
}

Eigen::MatrixXd ShapeKnowledge::observedPart(const Mat4& covariance_of_parameters) const {
  const Eigen::MatrixXd projection = basis.leftCols(observed).transpose() * hessian;
  return projection * covariance_of_parameters * projection.transpose();
}

Mat4 ShapeKnowledge::information() const {
  if (observed == 0) return Mat4::Zero();
  const Eigen::MatrixXd projection = basis.leftCols(observed).transpose() * hessian;
  const Eigen::MatrixXd inverse = observedPart(covariance).inverse();
  const Mat4 result = projection.transpose() * inverse * projection;
  return 0.5 * (result + result.transpose());
}

ShapeKnowledge knowledgeOf(const ShapeProblem& problem, const ShapeState& state,
                           const std::vector<ShapeRow>& rows, const ConsideredSigmas& considered) {
  ShapeKnowledge knowledge;
  if (rows.empty()) return knowledge;
  knowledge.usual_error = usualError(rows);
  knowledge.inliers = static_cast<int>(std::count_if(
      rows.begin(), rows.end(), [](const ShapeRow& row) { return std::abs(row.error) <= 3.0; }));
  const ShapeSums sums = sumsOf(problem, state, rows);
  // A parameter that no row depends on keeps a positive pivot; it is all noise.
  Mat4 noise = sums.noise, hessian = sums.hessian;
  for (int i = 0; i < 4; ++i) {
    hessian(i, i) += 1e-6;
    noise(i, i) += 1e-6;
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<Mat4> solver(noise, hessian);
  if (solver.info() != Eigen::Success || !solver.eigenvalues().allFinite()) return knowledge;
  knowledge.hessian = hessian;
  knowledge.basis = solver.eigenvectors();
  knowledge.noise_share = solver.eigenvalues();
  while (knowledge.observed < 4 && knowledge.noise_share[knowledge.observed] <= kMostNoiseShare)
    ++knowledge.observed;
  knowledge.step = -knowledge.basis.transpose() * sums.gradient;

  const Mat4 inverse = hessian.inverse();
  Mat4 covariance = inverse * sums.scores * inverse;
  const Mat4 by_considered = inverse * sums.considered;
  // Errors of both clouds may add or cancel: twice the sum of their squares bounds either.
  const Vec4 variances(squared(considered.scale), squared(considered.scale), squared(considered.tilt_rad),
                       squared(considered.tilt_rad));
  covariance += 2.0 * by_considered * variances.asDiagonal() * by_considered.transpose();
  const double shift = 2.0 * squared(considered.local_drift * sightOf(problem.newCloud()));
  covariance.diagonal() += Vec4(shift, shift, shift, 2.0 * squared(considered.local_drift));
  knowledge.covariance = 0.5 * (covariance + covariance.transpose());
  return knowledge;
}

std::optional<double> usualErrorWithin(const LocalCloud& cloud, int neighbours) {
  constexpr size_t kLeastRows = 30;
  LocalCloud half = cloud, other = cloud;
  half.points.clear();
  other.points.clear();
  for (size_t i = 0; i < cloud.points.size(); ++i) (i % 2 ? half : other).points.push_back(cloud.points[i]);
  const auto rows = ShapeProblem(half, other, neighbours).rows({});
  if (rows.size() < kLeastRows) return std::nullopt;
  return usualError(rows);
}

}  // namespace lodeline
