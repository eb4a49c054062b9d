#include "lodeline/factors/intrinsics_factor.h"

#include <algorithm>
#include <utility>

#include "lodeline/cameras/fit_camera.h"

namespace lodeline {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;

/// Coefficients [k_1, k_2, p_1, p_2, q_1, q_2] of an intrinsics block.
Eigen::Map<const Vec6> distortionOf(const double* intrinsics) {
  return Eigen::Map<const Vec6>(intrinsics + 4);
}

// Part of the effect of a tilt that points outwards, see the header.
constexpr double kTiltOutwards = 1.5;

/// Derivatives of the shift d(p), in the plane, by these coefficients.
Eigen::Matrix<double, 2, 6> shapesAt(const Vec2& p) {
  const double squared = p.squaredNorm();
  Eigen::Matrix<double, 2, 6> shapes;
  shapes << squared * p, squared * squared * p, squared * Vec2::UnitY() + 2.0 * p.y() * p,
      squared * Vec2::UnitX() + 2.0 * p.x() * p,
      squared * (squared * Mat2::Identity() + kTiltOutwards * p * p.transpose());
  return shapes;
}

/// Derivative of the shift d(p) by p.
Mat2 shiftByPlace(const Vec2& p, const Vec6& distortion) {
  const double squared = p.squaredNorm();
  const Vec2 tangential(distortion[3], distortion[2]), tilt = distortion.tail<2>();
  const double tilted = kTiltOutwards * tilt.dot(p);
  const double along =
      (distortion[0] + distortion[1] * squared) * squared + 2.0 * tangential.dot(p) + squared * tilted;
  const double outwards = 2.0 * (distortion[0] + 2.0 * distortion[1] * squared + tilted);
  return along * Mat2::Identity() + outwards * p * p.transpose() +
         2.0 * (tangential * p.transpose() + p * tangential.transpose()) +
         squared * (4.0 * tilt * p.transpose() + kTiltOutwards * p * tilt.transpose());
}

/// Predicted position of a point in the image.
struct Place {
  Vec2 from_centre_sigmas, in_plane;

  Place(const DirectionMeasurement& measurement, const Vec2& residual) {
    // A point behind the camera has no predicted pixel; the observed pixel stands in for it.
    constexpr double kFar_sigmas = 200.0;
    const Vec2 moved = residual.squaredNorm() < kFar_sigmas * kFar_sigmas ? residual : Vec2::Zero();
    from_centre_sigmas = measurement.from_centre_sigmas + moved;
    in_plane = measurement.in_plane + measurement.in_plane_by_sigmas * moved;
  }
  Eigen::Matrix<double, 2, kIntrinsicsSize> shapes(const DirectionMeasurement& measurement) const {
    Eigen::Matrix<double, 2, kIntrinsicsSize> shapes;
    shapes << Mat2(from_centre_sigmas.asDiagonal()), measurement.sigmas_per_px * Mat2::Identity(),
        measurement.focal_lengths_sigmas.asDiagonal() * shapesAt(in_plane);
    return shapes;
  }
};

/// The lens of the same model that is closest to `lens` with the shift d(p) added.
CameraCalibration withDistortion(const CameraCalibration& lens, const Vec6& distortion) {
  const auto camera = makeCamera(lens);
  const Vec2 focal_lengths_px = camera->focalLengthsOnAxis_px();
  std::vector<RayObservation> observations = imageObservations(*camera);
  for (RayObservation& observation : observations) {
    Mat23 by_ray;
    const Vec2 place = placeInPlane(camera->model().plane, observation.ray_C, &by_ray);
    observation.pixel += focal_lengths_px.cwiseProduct(shapesAt(place) * distortion);
  }
  return fitCamera(lens, std::move(observations)).calibration;
}

}  // namespace

Vec2 intrinsicsShift(const DirectionMeasurement& measurement, const Vec2& residual,
                     const double* intrinsics) {
  return Place(measurement, residual).shapes(measurement) *
         Eigen::Map<const Eigen::Matrix<double, kIntrinsicsSize, 1>>(intrinsics);
}

IntrinsicsEffect intrinsicsEffect(const DirectionMeasurement& measurement, const Vec2& residual,
                                  const double* intrinsics) {
  const Place place(measurement, residual);
  IntrinsicsEffect effect;
  effect.by_intrinsics = place.shapes(measurement);
  effect.shift =
      effect.by_intrinsics * Eigen::Map<const Eigen::Matrix<double, kIntrinsicsSize, 1>>(intrinsics);
  effect.by_residual = measurement.focal_lengths_sigmas.asDiagonal() *
                       shiftByPlace(place.in_plane, distortionOf(intrinsics)) *
                       measurement.in_plane_by_sigmas;
  effect.by_residual.diagonal() += Vec2(1.0 + intrinsics[0], 1.0 + intrinsics[1]);
  return effect;
}

Vec3 rayThrough(const DirectionMeasurement& measurement, const double* intrinsics) {
  // Solves residual + shift(residual) = 0 by fixed-point iteration. The shift hardly depends on the residual,
  // so three passes suffice.
  constexpr int kPasses = 3;
  Vec2 residual = Vec2::Zero();
  for (int pass = 0; pass < kPasses; ++pass) residual = -intrinsicsShift(measurement, residual, intrinsics);
  const Vec2 offset = measurement.sqrt_information.inverse() * residual;
  return (measurement.bearing_C + measurement.tangent_C * offset).normalized();
}

CameraCalibration correctedIntrinsics(const CameraCalibration& file, const double* intrinsics) {
  CameraCalibration lens = file;
  lens.fx_px *= 1.0 + intrinsics[0];
  lens.fy_px *= 1.0 + intrinsics[1];
  lens.cx_px += intrinsics[2];
  lens.cy_px += intrinsics[3];
  const Vec6 distortion = distortionOf(intrinsics);
  if (distortion.isZero(0.0)) return lens;
  const CameraModel* radial = findCameraModel(cameraModel(file).radial_model);
  const bool is_in_model = radial && distortion.tail<2>().isZero(0.0) &&
                           (radial->tangential_at || distortion.segment<2>(2).isZero(0.0));
  // Behind a port, the corrections are those of directions in the water and not of the lens.
  if (!is_in_model || file.port) return withDistortion(lens, distortion);
  lens.model = radial->name;
  lens.distortion.resize(std::max(lens.distortion.size(), radial->counts.front()), 0.0);
  for (size_t i = 0; i < 2; ++i) {
    lens.distortion[i] += distortion[static_cast<Eigen::Index>(i)];
    if (radial->tangential_at)
      lens.distortion[*radial->tangential_at + i] += distortion[static_cast<Eigen::Index>(i + 2)];
  }
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
  const IntrinsicsEffect effect = intrinsicsEffect(measurement_, residual, parameters[last]);
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
