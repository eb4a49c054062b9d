#pragma once

#include <ceres/cost_function.h>

#include <functional>
#include <memory>
#include <vector>

#include "lodeline/cameras/ports/refractive_camera.h"
#include "lodeline/factors/direction_measurement.h"

namespace lodeline {

// Parameter block of the port of a camera, zero where its file is right (correctedPort()):
//   flat  [x, y, z]   turn of the normal about x and y of C (rad), change of the distance (m)
//   dome  [x, y, z]   change of the centre (m), axes of C

constexpr int kPortChangeSize = 3;

/// The measurement of a pixel as if the port of its camera were changed. Weight and curvature stay.
DirectionMeasurement throughPort(const RefractiveCamera& camera, const DirectionMeasurement& measurement,
                                 const Vec3& change);

/// Reprojection error of a camera behind a port with the place of the port as a variable: residual
///   r = W (pi(p, port) - u)
/// with the measured pixel u, the exact projection pi of the point p in C, and the weight W of the
/// measurement (1 / sigma_px). The point comes from another reprojection factor. For a ray of unit weight
/// without curvature, that factor has the residual o = B^T q / (z^T q). With the ray moved aside by b_1 h,
/// the first coordinate of o falls by h w, w = rho / (z^T q). Then p = (z + B o) / w. The block of the port
/// is the last one. A point without a pixel has a large constant residual and zero derivatives.
class PortFactor final : public ceres::CostFunction {
 public:
  /// Makes the factor of a measurement. Its blocks come before that of the port.
  using FactorOf = std::function<std::unique_ptr<ceres::CostFunction>(const DirectionMeasurement&)>;

  /// `camera`: by the file.
  PortFactor(const FactorOf& factor_of, const DirectionMeasurement& measurement,
             std::shared_ptr<const RefractiveCamera> camera);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  /// Derivatives of [o, w] by a block, row by row.
  using PlaceByBlock = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  struct Place;
  struct Projection;

  bool locate(double const* const* parameters, double** jacobians, Place* place) const;

  std::unique_ptr<ceres::CostFunction> ahead_, aside_;
  std::shared_ptr<const RefractiveCamera> camera_;
  Vec3 bearing_C_;
  Mat32 tangent_C_;
  Vec2 pixel_ = Vec2::Zero();
  Mat2 weight_ = Mat2::Zero();
};

}  // namespace lodeline
