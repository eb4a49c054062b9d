#pragma once

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "lodeline/cameras/camera_model.h"
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

  /// Moves both poses by the same rotation and translation of the world.
  void moveWorld() {
    const Rigid3 moved_from_world(so3::exp(Vec3(0.5, -2.0, 0.7)), Vec3(30, -20, 10));
    world_from_host = moved_from_world * world_from_host;
    world_from_target = moved_from_world * world_from_target;
  }

  DirectionMeasurement measurement(const Vec3& point_C, double sigma_px = 0.7) const {
    return DirectionMeasurement::fromBearing(*camera, point_C.normalized(), sigma_px);
  }
};

/// Calibration of the same camera with another model: its typical lens, with the same focal length on the
/// axis.
inline CameraCalibration withModel(const std::string& name) {
  CameraCalibration file = ReprojectionScene::calibration();
  const Vec2 focal_lengths_px(file.fx_px, file.fy_px);
  file.model = name;
  file.distortion = cameraModel(file).typical.parameters;
  file.fx_px = file.fy_px = 1.0;
  const Vec2 on_axis_px = makeCamera(file)->focalLengthsOnAxis_px();
  file.fx_px = focal_lengths_px.x() / on_axis_px.x();
  file.fy_px = focal_lengths_px.y() / on_axis_px.y();
  return file;
}

/// All registered models, for parameterized tests, and the names of such tests.
inline std::vector<std::string> modelNames() {
  std::vector<std::string> names;
  for (const CameraModel& model : cameraModels()) names.emplace_back(model.name);
  return names;
}
inline std::string modelTestName(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
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
