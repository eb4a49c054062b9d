#include "lodeline/magnetometer/iron/heading_error.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "lodeline/geometry/so3.h"
#include "lodeline/magnetometer/iron/iron_calibration.h"
#include "lodeline/magnetometer/iron/sphere_coverage.h"

namespace lodeline {
namespace {

using fit_parameter::kSize;

/// Derivative of the corrected field in body axes (without the rotation: R_B_M = 1) by the parameters, at the
/// reading whose corrected field is `field_M`.
Eigen::Matrix<double, 3, kSize> fieldJacobian(const MagnetometerFit& fit, const Vec3& field_M) {
  const Vec3 d = fit.iron_correction.ldlt().solve(field_M);
  Eigen::Matrix<double, 3, kSize> j;
  j.leftCols<6>() << d.x(), 0, 0, d.y(), d.z(), 0,  //
      0, d.y(), 0, d.x(), 0, d.z(),                 //
      0, 0, d.z(), 0, d.x(), d.y();
  j.middleCols<3>(fit_parameter::kHardIron) = -fit.iron_correction;
  // exp(delta) R m = R m + delta x R m, in body axes; rotated back into M with R^T.
  const Mat3 r = fit.body_from_magnetometer.value_or(Quat::Identity()).toRotationMatrix();
  j.rightCols<3>() = -so3::skew(field_M) * r.transpose();
  return j;
}

template <typename Function>
void forAllDirections(const Function& function) {
  for (int zone = 0; zone < SphereCoverage::kZones; ++zone) {
    for (int sector = 0; sector < SphereCoverage::kSectors; ++sector) {
      function(SphereCoverage::middle(zone, sector));
    }
  }
}
constexpr double kDirections = SphereCoverage::kZones * SphereCoverage::kSectors;

/// Scales A to unit determinant. Heading does not depend on scale, which may come from a site in one
/// calibration and from the sensor in the other.
MagnetometerFit withUnitDeterminant(MagnetometerFit fit) {
  const bool raw_readings = std::exchange(fit.raw_readings, false);
  settleScale(std::nullopt, &fit);
  fit.raw_readings = raw_readings;
  return fit;
}

/// 99.7 % quantile of chi-square (Wilson & Hilferty, PNAS 1931).
double chiSquareLimit(int degrees_of_freedom) {
  constexpr double kNormalQuantile = 2.748;
  const double n = degrees_of_freedom;
  return n * std::pow(1.0 - 2.0 / (9.0 * n) + kNormalQuantile * std::sqrt(2.0 / (9.0 * n)), 3);
}

}  // namespace

double headingSigma(const MagnetometerFit& fit, double dip_rad) {
  double sum = 0.0;
  forAllDirections([&](const Vec3& u) {
    const Eigen::Matrix<double, 3, kSize> j = fieldJacobian(fit, fit.field_strength_T * u);
    const Mat3 p = j * fit.covariance * j.transpose();
    sum += (p.trace() - u.dot(p * u)) / 2.0;
  });
  const double turned = fit.field_strength_T * fit.axes_sigma_rad;
  return std::sqrt(std::max(0.0, sum / kDirections) + turned * turned) /
         (fit.field_strength_T * std::cos(dip_rad));
}

CalibrationDifference compareCalibrations(const MagnetometerFit& first_as_scaled,
                                          const MagnetometerFit& second_as_scaled, double dip_rad) {
  const MagnetometerFit first = withUnitDeterminant(first_as_scaled);
  const MagnetometerFit second = withUnitDeterminant(second_as_scaled);
  CalibrationDifference result;
  result.hard_iron = second.hard_iron - first.hard_iron;
  result.iron_correction = second.iron_correction - first.iron_correction;
  Eigen::Matrix<double, kSize, 1> difference = Eigen::Matrix<double, kSize, 1>::Zero();
  difference << symmetricEntries(result.iron_correction), result.hard_iron, Vec3::Zero();
  MagnetometerFit::Covariance covariance = first.covariance + second.covariance;
  Quat change = Quat::Identity();  // rotation change, in magnetometer axes of the first
  if (first.body_from_magnetometer && second.body_from_magnetometer) {
    result.rotation_rad =
        so3::log(*second.body_from_magnetometer * first.body_from_magnetometer->conjugate());
    difference.tail<3>() = *result.rotation_rad;
    change = first.body_from_magnetometer->conjugate() * *second.body_from_magnetometer;
  }
  result.sigmas = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();

  // Scaled to a unit diagonal. A direction without variance (a scale fixed by convention) is left out.
  const Eigen::Matrix<double, kSize, 1> scale =
      result.sigmas.unaryExpr([](double sigma) { return sigma > 0.0 ? 1.0 / sigma : 0.0; });
  covariance = (scale.asDiagonal() * covariance * scale.asDiagonal()).eval();
  const Eigen::SelfAdjointEigenSolver<MagnetometerFit::Covariance> solver(covariance);
  const Eigen::Matrix<double, kSize, 1> along =
      solver.eigenvectors().transpose() * scale.asDiagonal() * difference;
  for (int i = 0; i < kSize; ++i) {
    if (solver.eigenvalues()[i] < 1e-9) continue;
    result.chi_square += along[i] * along[i] / solver.eigenvalues()[i];
    ++result.degrees_of_freedom;
  }
  result.significant =
      result.degrees_of_freedom > 0 && result.chi_square > chiSquareLimit(result.degrees_of_freedom);

  double square = 0.0;
  forAllDirections([&](const Vec3& u) {
    const Vec3 reading = first.hard_iron + first.iron_correction.ldlt().solve(first.field_strength_T * u);
    const Vec3 other = change * second.corrected_M(reading);
    const Vec3 across = other / other.norm() - u;
    square += across.squaredNorm() / 2.0;
    result.heading_largest_rad = std::max(result.heading_largest_rad, across.norm());
  });
  result.heading_rms_rad = std::sqrt(square / kDirections) / std::cos(dip_rad);
  result.heading_largest_rad /= std::cos(dip_rad);
  return result;
}

}  // namespace lodeline
