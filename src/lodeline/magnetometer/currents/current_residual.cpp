#include "lodeline/magnetometer/currents/current_residual.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr double kOutlierWeight = 0.1;

/// Heading error of a difference of readings, rad. Without a vertical, every direction is as likely.
double headingOf(const TestTable& table, const Eigen::RowVector3d& difference_uT) {
  if (table.is_level_known) return std::abs(difference_uT.dot(table.heading_by_reading));
  return difference_uT.norm() / std::sqrt(3.0) * table.heading_by_reading.norm();
}

}  // namespace

CurrentResidual residualOf(const CurrentFit& fit, const Eigen::MatrixXd& left_T_per_A) {
  CurrentResidual result;
  int count = 0;
  for (Eigen::Index row = 0; row < fit.lines.residuals.rows(); ++row) {
    if (fit.lines.weights[row] < kOutlierWeight) continue;
    const Eigen::RowVector3d difference_uT =
        fit.lines.residuals.row(row) + 1e6 * fit.currents_A.row(row) * left_T_per_A;
    const double heading_rad = headingOf(fit.table, difference_uT);
    result.rms_T += difference_uT.squaredNorm();
    result.heading_rms_rad += heading_rad * heading_rad;
    result.heading_largest_rad = std::max(result.heading_largest_rad, heading_rad);
    ++count;
  }
  result.rms_T = 1e-6 * std::sqrt(result.rms_T / std::max(1, count));
  result.heading_rms_rad = std::sqrt(result.heading_rms_rad / std::max(1, count));
  return result;
}

double slowHeading_rad(const CurrentFit& fit) {
  constexpr double kSpan_s = 1.0;
  const TestTable& table = fit.table;
  const RobustLines& lines = fit.lines;
  double square = 0.0;
  int spans = 0;
  for (Eigen::Index begin = 0; begin < lines.residuals.rows();) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    double weight = 0.0;
    Eigen::Index row = begin;
    for (; row < lines.residuals.rows() && table.times_s[row] < table.times_s[begin] + kSpan_s; ++row) {
      if (lines.weights[row] < kOutlierWeight) continue;
      sum += lines.residuals.row(row);
      weight += 1.0;
    }
    begin = row;
    if (weight == 0.0) continue;
    square += std::pow(headingOf(table, sum / weight), 2);
    ++spans;
  }
  return std::sqrt(square / std::max(1, spans));
}

double rateOf(std::span<const CurrentSample> samples) {
  const double step_s = medianStep_s(samples);
  return step_s > 0.0 ? 1.0 / step_s : 0.0;
}

}  // namespace lodeline
