#include "lodeline/factors/intrinsics_factor.h"

#include <utility>

namespace lodeline {

Eigen::Matrix<double, 2, kIntrinsicsSize> residualByIntrinsics(const DirectionMeasurement& measurement) {
  const Vec2& from_centre = measurement.from_centre_sigmas;
  const double sine_squared = measurement.bearing_C.head<2>().squaredNorm();
  Eigen::Matrix<double, 2, kIntrinsicsSize> derivative;
  derivative << Mat2(from_centre.asDiagonal()), measurement.sigmas_per_px * Mat2::Identity(),
      sine_squared * from_centre, sine_squared * sine_squared * from_centre;
  return derivative;
}

CameraCalibration correctedLens(const CameraCalibration& file, const double* intrinsics) {
  CameraCalibration lens = file;
  lens.fx_px *= 1.0 + intrinsics[0];
  lens.fy_px *= 1.0 + intrinsics[1];
  lens.cx_px += intrinsics[2];
  lens.cy_px += intrinsics[3];
  const double k_1 = intrinsics[4], k_2 = intrinsics[5];
  if (k_1 == 0.0 && k_2 == 0.0) return lens;
  if (lens.distortion_model == DistortionModel::None) {
    lens.distortion_model = DistortionModel::RadialTangential;
    lens.distortion.clear();
  }
  if (lens.distortion.size() < 4) lens.distortion.resize(4, 0.0);
  // sin^2 in powers of what the model counts in: r^2 - r^4 for the tangent, theta^2 - theta^4 / 3 for the
  // angle.
  const double fourth = lens.distortion_model == DistortionModel::Equidistant ? 1.0 / 3.0 : 1.0;
  lens.distortion[1] += k_2 - fourth * k_1 + lens.distortion[0] * k_1;
  lens.distortion[0] += k_1;
  return lens;
}

IntrinsicsFactor::IntrinsicsFactor(std::unique_ptr<ceres::CostFunction> factor,
                                   const DirectionMeasurement& measurement)
    : factor_(std::move(factor)), by_intrinsics_(residualByIntrinsics(measurement)) {
  set_num_residuals(2);
  *mutable_parameter_block_sizes() = factor_->parameter_block_sizes();
  mutable_parameter_block_sizes()->push_back(kIntrinsicsSize);
}

bool IntrinsicsFactor::Evaluate(double const* const* parameters, double* residuals,
                                double** jacobians) const {
  if (!factor_->Evaluate(parameters, residuals, jacobians)) return false;
  const size_t last = parameter_block_sizes().size() - 1;
  Eigen::Map<Vec2>(residuals, 2) +=
      by_intrinsics_ * Eigen::Map<const Eigen::Matrix<double, kIntrinsicsSize, 1>>(parameters[last]);
  if (jacobians && jacobians[last]) {
    Eigen::Map<Eigen::Matrix<double, 2, kIntrinsicsSize, Eigen::RowMajor>> by_intrinsics(jacobians[last]);
    by_intrinsics = by_intrinsics_;
  }
  return true;
}

}  // namespace lodeline
