#include "lodeline/factors/intrinsics_factor.h"

#include <algorithm>
#include <utility>

#include "lodeline/cameras/fit_camera.h"

namespace lodeline {
namespace {

/// Predicted position of a point in the image.
struct Place {
  Vec2 from_centre_sigmas, in_plane, outwards_sigmas;
  double radius_squared;

  Place(const DirectionMeasurement& measurement, const Vec2& residual) {
    // A point behind the camera has no predicted pixel; the observed pixel stands in for it.
    constexpr double kFar_sigmas = 200.0;
    const Vec2 moved = residual.squaredNorm() < kFar_sigmas * kFar_sigmas ? residual : Vec2::Zero();
    from_centre_sigmas = measurement.from_centre_sigmas + moved;
    in_plane = measurement.in_plane + measurement.in_plane_by_sigmas * moved;
    outwards_sigmas = measurement.focal_lengths_sigmas.cwiseProduct(in_plane);
    radius_squared = in_plane.squaredNorm();
  }
  /// Change of the radial polynomial at this position, k_1 |p|^2 + k_2 |p|^4.
  double profile(const double* intrinsics) const {
    return intrinsics[4] * radius_squared + intrinsics[5] * radius_squared * radius_squared;
  }
  Vec2 shift(const DirectionMeasurement& measurement, const double* intrinsics) const {
    return Vec2(intrinsics[0], intrinsics[1]).cwiseProduct(from_centre_sigmas) +
           measurement.sigmas_per_px * Vec2(intrinsics[2], intrinsics[3]) +
           profile(intrinsics) * outwards_sigmas;
  }
};

/// The lens of the same model that is closest to `lens` with the profile k_1 |p|^2 + k_2 |p|^4 added.
CameraCalibration withProfile(const CameraCalibration& lens, double k_1, double k_2) {
  const auto camera = makeCamera(lens);
  const Vec2 focal_lengths_px = camera->focalLengthsOnAxis_px();
  std::vector<Sighting> sightings = imageSightings(*camera);
  for (Sighting& sighting : sightings) {
    Mat23 by_ray;
    const Vec2 place = placeInPlane(camera->model().plane, sighting.ray_C, &by_ray);
    const double squared = place.squaredNorm();
    sighting.pixel += (k_1 * squared + k_2 * squared * squared) * focal_lengths_px.cwiseProduct(place);
  }
  return fitCamera(lens, std::move(sightings)).calibration;
}

}  // namespace

Vec2 intrinsicsShift(const DirectionMeasurement& measurement, const Vec2& residual,
                     const double* intrinsics) {
  return Place(measurement, residual).shift(measurement, intrinsics);
}

IntrinsicsEffect intrinsicsEffect(const DirectionMeasurement& measurement, const Vec2& residual,
                                  const double* intrinsics) {
  const Place place(measurement, residual);
  const double squared = place.radius_squared;
  IntrinsicsEffect effect;
  effect.by_intrinsics << Mat2(place.from_centre_sigmas.asDiagonal()),
      measurement.sigmas_per_px * Mat2::Identity(), squared * place.outwards_sigmas,
      squared * squared * place.outwards_sigmas;
  effect.shift = place.shift(measurement, intrinsics);
  Mat2 by_place = 2.0 * (intrinsics[4] + 2.0 * intrinsics[5] * squared) * place.outwards_sigmas *
                  place.in_plane.transpose();
  by_place.diagonal() += place.profile(intrinsics) * measurement.focal_lengths_sigmas;
  effect.by_residual = by_place * measurement.in_plane_by_sigmas;
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
  const double k_1 = intrinsics[4], k_2 = intrinsics[5];
  if (k_1 == 0.0 && k_2 == 0.0) return lens;
  const CameraModel* radial = findCameraModel(cameraModel(file).radial_model);
  // Behind a port, the corrections are those of directions in the water and not of the lens.
  if (radial == nullptr || file.port) return withProfile(lens, k_1, k_2);
  lens.model = radial->name;
  lens.distortion.resize(std::max(lens.distortion.size(), radial->counts.front()), 0.0);
  lens.distortion[0] += k_1;
  lens.distortion[1] += k_2;
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
