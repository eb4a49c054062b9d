#pragma once

#include <ceres/cost_function.h>

#include <array>
#include <optional>
#include <vector>

#include "lodeline/estimator/sonar/beam_surface.h"
#include "lodeline/factors/parameters.h"
#include "lodeline/factors/reprojection_factor.h"

namespace lodeline {

/// A beam in body axes.
struct SonarBeam {
  Vec3 origin_B = Vec3::Zero();    ///< the sonar's lever arm, m
  Mat3 axes_B = Mat3::Identity();  ///< columns: along the beam, and two directions across
};

/// A landmark near the beam.
struct SurfaceLandmark {
  LandmarkBase base;
  size_t host = 0;  ///< index of its host among the host poses
  double weight = 1.0;
};

/// Linearization points of the blocks (factors/parameters.h); null: the Jacobian is taken at the current
/// value.
struct SonarLinearizationPoints {
  std::optional<std::array<double, kPoseSize>> pose = std::nullopt;
  std::vector<const double*> hosts = {};
  const double* camera = nullptr;
};

/// Range of an echo, to the surface that landmarks near its beam form: 1 residual. Blocks: pose at the
/// time of the echo (7, world_from_body), poses of the host frames (7 each), extrinsics of camera 0 (6,
/// only where they are estimated), landmarks (3 each).
///
/// R, p is the pose of the body at the echo, o the beam's origin and A its axes in the body. R_h, p_h is
/// the pose of the host, R_C, p_C the camera in the body. A landmark (direction d, inverse distance rho)
/// has
///   q = A^T (R^T (R_h (R_C d + rho p_C) + rho (p_h - p)) - rho o)
///   a = q_1 / q_0,   b = q_2 / q_0,   y = rho / q_0                 (1/m)
///   e = (1 / w_0 - range) / sigma,   w_0 = inverse distance of the BeamSurface of all (a, b, y).
/// The weights of the landmarks are constants. A surface behind the sonar or beyond kFarthest_m is a gross
/// outlier: constant error, zero Jacobian. Derivation: docs/theory/sonar.md.
class SonarRangeFactor final : public ceres::CostFunction {
 public:
  static constexpr double kFarthest_m = 1e3;

  /// `body_from_camera`: camera 0 by its file. `is_camera_estimated`: with the block of its extrinsics.
  /// Throws InputError for a range or sigma that is not positive, and for fewer than three landmarks.
  SonarRangeFactor(double range_m, double sigma_m, const SonarBeam& beam, const Rigid3& body_from_camera,
                   bool is_camera_estimated, size_t hosts, std::vector<SurfaceLandmark> landmarks,
                   SonarLinearizationPoints linearization_points = {});

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  struct Geometry;
  Geometry geometryAt(double const* const* parameters, bool at_linearization_points) const;
  void differentiate(const Geometry& geometry, double const* const* parameters, double** jacobians) const;
  size_t cameraBlock() const { return 1 + hosts_; }
  size_t landmarkBlock(size_t landmark) const {
    return 1 + hosts_ + (is_camera_estimated_ ? 1 : 0) + landmark;
  }

  double range_m_, sigma_m_;
  SonarBeam beam_;
  Rigid3 body_from_camera_;
  bool is_camera_estimated_;
  size_t hosts_;
  std::vector<SurfaceLandmark> landmarks_;
  SonarLinearizationPoints first_;
};

}  // namespace lodeline
