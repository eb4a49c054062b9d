#pragma once

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "lodeline/cameras/camera.h"
#include "lodeline/factors/numeric_jacobian.h"
#include "lodeline/factors/reprojection_factor.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {

/// Test support: a landmark in front of a typical camera, observed from two body poses.
struct ReprojectionScene {
  std::shared_ptr<const Camera> camera = makeCamera(calibration());
  Rigid3 world_from_host{so3::exp(Vec3(0.3, 0.2, 1.0)), Vec3(1.0, -2.0, 0.5)};
  Rigid3 world_from_target{so3::exp(Vec3(0.35, 0.15, 1.1)), Vec3(1.2, -1.8, 0.6)};
  Vec3 point_host_C{0.4, -0.3, 2.5};

  static CameraCalibration calibration() {
    CameraCalibration calibration;
    calibration.name = "cam0";
    calibration.width_px = 752;
    calibration.height_px = 480;
    calibration.fx_px = 458.0;
    calibration.fy_px = 457.0;
    calibration.cx_px = 367.0;
    calibration.cy_px = 248.0;
    calibration.model = "radial-tangential";
    calibration.distortion = {-0.283, 0.074, 0.0002, 1.8e-5};
    return calibration;
  }

  /// The base of the landmark, whose bearing deviates slightly from the true direction.
  LandmarkBase base() const { return LandmarkBase((point_host_C + Vec3(0.02, 0.01, 0.0)).normalized()); }

  /// The landmark's true parameters.
  Eigen::VectorXd landmark() const {
    const LandmarkBase b = base();
    const double depth = b.bearing_C.dot(point_host_C);
    const Vec2 ab = b.tangent_C.transpose() * point_host_C / depth;
    return Vec3(ab.x(), ab.y(), 1.0 / depth);
  }

  DirectionMeasurement measurement(const Vec3& point_C, double sigma_px = 0.7) const {
    return DirectionMeasurement::fromBearing(*camera, point_C.normalized(), sigma_px);
  }
};

/// Calibration of the same camera with another distortion model.
inline CameraCalibration withModel(DistortionModel model) {
  CameraCalibration file = ReprojectionScene::calibration();
  file.model = model;
  if (model == "none") file.distortion.clear();
  if (model == "equidistant") file.distortion = {-0.02, 0.01, -0.003, 0.001};
  return file;
}

/// Residual of a factor with two rows.
inline Vec2 evaluate(const ceres::CostFunction& factor, const std::vector<Eigen::VectorXd>& parameters) {
  std::vector<const double*> pointers;
  for (const auto& block : parameters) pointers.push_back(block.data());
  Vec2 residual;
  EXPECT_TRUE(factor.Evaluate(pointers.data(), residual.data(), nullptr));
  return residual;
}

}  // namespace lodeline
