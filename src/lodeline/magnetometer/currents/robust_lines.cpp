#include "lodeline/magnetometer/currents/robust_lines.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "lodeline/magnetometer/iron/iron_fit.h"

namespace lodeline {
namespace {

constexpr int kRounds = 8;
constexpr double kCauchy = 2.385;
constexpr double kLeastSigma = 1e-6;  // uT; of residuals that are exactly zero

double robustSigmaOf(const RobustLines& lines) {
  std::vector<double> values;
  for (Eigen::Index row = 0; row < lines.residuals.rows(); ++row) {
    if (lines.weights[row] == 0.0) continue;
    for (Eigen::Index axis = 0; axis < lines.residuals.cols(); ++axis)
      values.push_back(lines.residuals(row, axis));
  }
  return values.empty() ? kLeastSigma : std::max(kLeastSigma, robustSigma(std::move(values)));
}

}  // namespace

RobustLines fitLines(const Eigen::MatrixXd& design, const Eigen::MatrixXd& right,
                     const Eigen::VectorXd& prior_sigmas, double sigma) {
  RobustLines lines;
  lines.weights.setOnes(design.rows());
  Eigen::MatrixXd known = design;
  for (Eigen::Index row = 0; row < design.rows(); ++row) {
    if (design.row(row).allFinite() && right.row(row).allFinite()) continue;
    lines.weights[row] = 0.0;
    known.row(row).setZero();
  }
  const Eigen::VectorXd is_row = lines.weights;
  const Eigen::MatrixXd sides = right.array().isFinite().select(right, 0.0);
  double used_sigma = sigma;
  for (int round = 0; round < kRounds; ++round) {
    lines.information = known.transpose() * lines.weights.asDiagonal() * known;
    Eigen::MatrixXd matrix = lines.information;
    // The priors count in units of the residuals' sigma.
    const double scale = used_sigma > 0.0 ? used_sigma : 1.0;
    matrix.diagonal() += (scale * prior_sigmas.cwiseInverse()).cwiseAbs2();
    const Eigen::LDLT<Eigen::MatrixXd> solver(matrix);
    lines.coefficients = solver.solve(known.transpose() * lines.weights.asDiagonal() * sides);
    lines.inverse = solver.solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
    lines.residuals = is_row.asDiagonal() * (sides - known * lines.coefficients);
    lines.sigma = robustSigmaOf(lines);
    used_sigma = sigma > 0.0 ? sigma : lines.sigma;
    lines.cost = 0.0;
    for (Eigen::Index row = 0; row < design.rows(); ++row) {
      const double ratio = lines.residuals.row(row).squaredNorm() / 3.0 / std::pow(kCauchy * used_sigma, 2);
      lines.cost += is_row[row] * std::log1p(ratio);
      lines.weights[row] = is_row[row] / (1.0 + ratio);
    }
  }
  return lines;
}

}  // namespace lodeline
