#include "lodeline/estimator/uncertainty/inertial_covariance_propagation.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

#include "lodeline/problem/covariance.h"
#include "lodeline/problem/normal_equations.h"

namespace lodeline {
namespace {

using Matrix15 = Eigen::Matrix<double, 15, 15>;

/// The blocks of a Hessian between pose and motion of two frames.
Matrix15 hessianOf(const NormalEquations& system, const Frame& rows, const Frame& columns) {
  const Eigen::MatrixXd hessian = system.hessian();
  Matrix15 block;
  int row = 0;
  for (const double* r : {rows.pose.data(), rows.motion.data()}) {
    const NormalEquations::Block& from = *system.find(r);
    int column = 0;
    for (const double* c : {columns.pose.data(), columns.motion.data()}) {
      const NormalEquations::Block& to = *system.find(c);
      block.block(row, column, from.tangentSize(), to.tangentSize()) =
          hessian.block(from.offset, to.offset, from.tangentSize(), to.tangentSize());
      column += to.tangentSize();
    }
    row += from.tangentSize();
  }
  return block;
}

/// Covariance of the newest frame's state after propagation by inertial readings from the frame before, whose
/// covariance is `known`.
Matrix15 carriedByInertialReadings(Window& window, const FactorBuilder& factors, const Matrix15& known) {
  Frame& newest = window.newest();
  Frame& before = *window.frames()[window.frames().size() - 2];
  NormalEquations system;
  system.add(factors.inertial(window, before, newest));
  // The whitened residual J_b b + J_n n has as many rows as n: n = -J_n^-1 J_b b plus noise with covariance
  // (J_n^T J_n)^-1.
  const Eigen::LLT<Matrix15> of_newest(hessianOf(system, newest, newest));
  const Matrix15 transition = -of_newest.solve(hessianOf(system, newest, before));
  return transition * known * transition.transpose() + of_newest.solve(Matrix15::Identity());
}

/// Covariance after the measurements of velocity of the newest frame.
Matrix15 measured(Window& window, const FactorBuilder& factors, const Matrix15& known) {
  Frame& newest = window.newest();
  Matrix15 information = Matrix15::Zero();
  for (const auto& measurement : newest.measurements) {
    if (!measurement->measuresVelocity() || measurement->isRelative()) continue;
    NormalEquations system;
    for (const Factor& factor : measurement->factors({factors, window, nullptr, newest})) system.add(factor);
    if (system.find(newest.motion.data())) information += hessianOf(system, newest, newest);
  }
  if (information.isZero(0.0)) return known;
  const Matrix15 updated = (Matrix15::Identity() + known * information).partialPivLu().solve(known);
  return 0.5 * (updated + updated.transpose());
}

}  // namespace

void InertialCovariancePropagation::follow(Window& window, const FactorBuilder& factors, bool is_blind,
                                           bool is_heading_told, Matrix15* claimed) {
  const bool is_known = isCovariance(*claimed);
  if ((!is_blind && is_known) || !carried_ || !window.newest().from_previous) {
    carried_ = *claimed;
    return;
  }
  carried_ = measured(window, factors, carriedByInertialReadings(window, factors, *carried_));
  if (!is_known) *claimed = *carried_;
  constexpr int kHeading = 5;
  for (const int i : {0, 1, kHeading, 6, 7}) {
    if (i == kHeading && is_heading_told) continue;
    (*claimed)(i, i) = std::max((*claimed)(i, i), (*carried_)(i, i));
  }
}

}  // namespace lodeline
