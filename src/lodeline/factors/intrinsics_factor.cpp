#include "lodeline/factors/intrinsics_factor.h"

#include <utility>

namespace lodeline {
namespace {

/// Where a point should be seen.
struct Place {
  Vec2 from_centre_sigmas, off_axis;
  double sine_squared;

  Place(const DirectionMeasurement& measurement, const Vec2& residual) {
    // Behind the camera there is no place that the point should be seen at.
    constexpr double kFar_sigmas = 200.0;
    const Vec2 moved = residual.squaredNorm() < kFar_sigmas * kFar_sigmas ? residual : Vec2::Zero();
    from_centre_sigmas = measurement.from_centre_sigmas + moved;
    off_axis = measurement.bearing_C.head<2>() + measurement.off_axis_by_sigmas * moved;
    sine_squared = off_axis.squaredNorm();
  }
  /// Relative change of the radial profile there.
  double profile(const double* intrinsics) const {
    return intrinsics[4] * sine_squared + intrinsics[5] * sine_squared * sine_squared;
  }
  Vec2 shift(const DirectionMeasurement& measurement, const double* intrinsics) const {
    const double profile = this->profile(intrinsics);
    return {(intrinsics[0] + profile) * from_centre_sigmas.x() + measurement.sigmas_per_px * intrinsics[2],
            (intrinsics[1] + profile) * from_centre_sigmas.y() + measurement.sigmas_per_px * intrinsics[3]};
  }
};

}  // namespace

Vec2 lensShift(const DirectionMeasurement& measurement, const Vec2& residual, const double* intrinsics) {
  return Place(measurement, residual).shift(measurement, intrinsics);
}

LensEffect lensEffect(const DirectionMeasurement& measurement, const Vec2& residual,
                      const double* intrinsics) {
  const Place place(measurement, residual);
  const double sine_squared = place.sine_squared;
  LensEffect effect;
  effect.by_intrinsics << Mat2(place.from_centre_sigmas.asDiagonal()),
      measurement.sigmas_per_px * Mat2::Identity(), sine_squared * place.from_centre_sigmas,
      sine_squared * sine_squared * place.from_centre_sigmas;
  effect.shift = place.shift(measurement, intrinsics);
  const Eigen::RowVector2d profile_by_residual = 2.0 * (intrinsics[4] + 2.0 * intrinsics[5] * sine_squared) *
                                                 place.off_axis.transpose() * measurement.off_axis_by_sigmas;
  effect.by_residual = place.from_centre_sigmas * profile_by_residual;
  effect.by_residual.diagonal() +=
      Vec2(1.0 + intrinsics[0], 1.0 + intrinsics[1]) + Vec2::Constant(place.profile(intrinsics));
  return effect;
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
    : factor_(std::move(factor)), measurement_(measurement) {
  set_num_residuals(2);
  *mutable_parameter_block_sizes() = factor_->parameter_block_sizes();
  mutable_parameter_block_sizes()->push_back(kIntrinsicsSize);
}

bool IntrinsicsFactor::Evaluate(double const* const* parameters, double* residuals,
                                double** jacobians) const {
  using RowMajor = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>;
  if (!factor_->Evaluate(parameters, residuals, jacobians)) return false;
  const std::vector<int>& sizes = parameter_block_sizes();
  const size_t last = sizes.size() - 1;
  Eigen::Map<Vec2> residual(residuals);
  const LensEffect effect = lensEffect(measurement_, residual, parameters[last]);
  residual += effect.shift;
  for (size_t block = 0; jacobians && block < sizes.size(); ++block) {
    if (!jacobians[block]) continue;
    Eigen::Map<RowMajor> jacobian(jacobians[block], 2, sizes[block]);
    if (block == last) {
      jacobian = effect.by_intrinsics;
    } else {
      jacobian = effect.by_residual * jacobian.eval();
    }
  }
  return true;
}

}  // namespace lodeline
