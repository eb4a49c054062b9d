#include "lodeline/estimator/sonar/beam_surface.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lodeline {
namespace {

// Added to the normal equations of the slopes, relative to the sum of the weights. It keeps points on a line
// from dividing by zero. Directions across are at most a few tenths, so that it does not matter otherwise.
constexpr double kLeastSpread = 1e-11;

}  // namespace

BeamSurface::BeamSurface(std::vector<BeamPoint> points) : points_(std::move(points)) {
  Mat3 information = Mat3::Zero();
  Vec3 right_side = Vec3::Zero();
  for (const BeamPoint& point : points_) {
    const Vec3 row = rowOf(point);
    information += point.weight * row * row.transpose();
    right_side += point.weight * point.inverse_distance_per_m * row;
  }
  information.diagonal().tail<2>().array() += kLeastSpread * information(0, 0);
  inverse_ = information.inverse();
  w_ = inverse_ * right_side;
}

Vec3 BeamSurface::derivatives(size_t index) const {
  const BeamPoint& point = points_[index];
  // Of the normal equations: dw = N (dA^T W r + A^T W (dy - dA w)).
  const double by_y = point.weight * inverse_.row(0).dot(rowOf(point));
  const double residual = point.weight * residualOf(point);
  return {residual * inverse_(0, 1) - by_y * w_[1], residual * inverse_(0, 2) - by_y * w_[2], by_y};
}

double BeamSurface::leverage() const {
  double sum = 0.0;
  for (const BeamPoint& point : points_) sum += std::pow(point.weight * inverse_.row(0).dot(rowOf(point)), 2);
  return sum;
}

double BeamSurface::scatter_per_m() const {
  constexpr double kUnknowns = 3.0;
  double squares = 0.0, weights = 0.0, squared_weights = 0.0;
  for (const BeamPoint& point : points_) {
    squares += point.weight * std::pow(residualOf(point), 2);
    weights += point.weight;
    squared_weights += point.weight * point.weight;
  }
  const double count = weights * weights / squared_weights;  // Kish's effective number
  if (count <= kUnknowns) return std::numeric_limits<double>::infinity();
  return std::sqrt(squares / weights * count / (count - kUnknowns));
}

}  // namespace lodeline
