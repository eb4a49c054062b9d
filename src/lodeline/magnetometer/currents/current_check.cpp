#include "lodeline/magnetometer/currents/current_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "lodeline/magnetometer/currents/current_residual.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

constexpr double kHarmful_rad = 0.5 * kDegree;

Vec3 calibratedField(const CurrentCalibration& calibration, const std::string& channel) {
  if (calibration.fields_T_per_A.size() != calibration.channels.size() || calibration.channels.empty())
    throw InputError("the calibration of currents to be checked holds no fields (fields_T_per_A)");
  const auto found = std::find(calibration.channels.begin(), calibration.channels.end(), channel);
  if (found == calibration.channels.end()) {
    throw InputError(
        fmt::format("the calibration of currents to be checked has no channel '{}'; its channels are '{}'",
                    channel, fmt::join(calibration.channels, "', '")));
  }
  return calibration.fields_T_per_A[static_cast<size_t>(found - calibration.channels.begin())];
}

std::string verdictOf(const CurrentCheck& check, const CurrentFit& fit) {
  const double degrees = check.with.heading_rms_rad / kDegree;
  if (check.is_moved) {
    return fmt::format(
        "Cables moved: do not use. The calibration leaves {:.2f} degrees of heading (root mean square); "
        "without it there are {:.2f}, with this test's own fields {:.2f}. Use the new calibration.",
        degrees, fit.without.heading_rms_rad / kDegree, fit.with.heading_rms_rad / kDegree);
  }
  return fmt::format(
      "{} The calibration leaves {:.2f} degrees of heading (root mean square) of {:.2f}.",
      check.contradiction.isSignificant() ? "Holds, with a small change." : "Holds: nothing has changed.",
      degrees, fit.without.heading_rms_rad / kDegree);
}

}  // namespace

bool CurrentContradiction::isSignificant() const {
  constexpr double kSigmas = 6.0;
  return chi_square > degrees_of_freedom + kSigmas * std::sqrt(2.0 * degrees_of_freedom);
}

CurrentContradiction contradictionOf(const Eigen::MatrixXd& differences_T_per_A,
                                     const Eigen::MatrixXd& covariance, double sigma_T_per_A) {
  Eigen::MatrixXd sum = covariance;
  sum.diagonal().array() += sigma_T_per_A * sigma_T_per_A;
  // In units of 1 uT/A, so that rounding does not matter.
  const Eigen::MatrixXd differences = 1e6 * differences_T_per_A;
  const Eigen::MatrixXd solved = (1e12 * sum).ldlt().solve(differences);
  return {(differences.transpose() * solved).trace(), static_cast<int>(3 * differences.rows())};
}

CurrentCheck checkCurrents(const CurrentFit& fit, const CurrentCalibration& calibration) {
  CurrentCheck check;
  std::vector<Eigen::Index> identified;
  Eigen::MatrixXd differences(static_cast<Eigen::Index>(fit.channels.size()), 3);
  for (size_t i = 0; i < fit.channels.size(); ++i) {
    const CurrentChannel& channel = fit.channels[i];
    const Vec3 difference = channel.field_T_per_A - calibratedField(calibration, channel.name);
    check.differences_T_per_A.push_back(difference);
    const bool is_known = fit.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) > 0.0;
    differences.row(static_cast<Eigen::Index>(i)) = (is_known ? 1.0 : 0.0) * difference.transpose();
    if (is_known) identified.push_back(static_cast<Eigen::Index>(i));
  }
  check.contradiction =
      contradictionOf(differences(identified, Eigen::all), fit.covariance(identified, identified),
                      calibration.field_sigma_T_per_A);
  check.with = residualOf(fit, differences);
  check.is_moved = check.contradiction.isSignificant() && check.with.heading_rms_rad > kHarmful_rad &&
                   check.with.heading_rms_rad > 1.5 * fit.with.heading_rms_rad;
  check.verdict = verdictOf(check, fit);
  return check;
}

}  // namespace lodeline
