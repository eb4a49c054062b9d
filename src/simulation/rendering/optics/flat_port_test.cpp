#include "simulation/rendering/optics/port_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "simulation/rendering/optics/test_lens.h"

namespace lodeline {
namespace {

TEST(FlatPort, BendsBySnellsLawWhateverTheGlass) {
  FlatPort port;
  const double in_air = 0.6;
  const auto ray = throughPort(port, Vec3(std::sin(in_air), 0.0, std::cos(in_air)));
  ASSERT_TRUE(ray);
  EXPECT_NEAR(ray->direction_C.x(), std::sin(in_air) / port.index_water, 1e-12);
  EXPECT_NEAR(ray->direction_C.norm(), 1.0, 1e-12);
  EXPECT_NEAR(ray->origin_C.z(), port.distance_m + port.thickness_m, 1e-12);
  const double in_glass = std::asin(std::sin(in_air) / port.index_glass);
  EXPECT_NEAR(ray->origin_C.x(), port.distance_m * std::tan(in_air) + port.thickness_m * std::tan(in_glass),
              1e-12);
}

TEST(FlatPort, AxisGoesStraightThroughEvenTilted) {
  FlatPort port;
  port.normal_C = Vec3(0.05, -0.02, 1.0).normalized();
  const auto ray = throughPort(port, port.normal_C);
  ASSERT_TRUE(ray);
  EXPECT_LT((ray->direction_C - port.normal_C).norm(), 1e-12);
  EXPECT_FALSE(throughPort(port, -Vec3::UnitZ()));
}

TEST(FlatPort, RefusesTotalReflection) {
  EXPECT_FALSE(refract(Vec3(0.9, 0.0, 0.4).normalized(), Vec3::UnitZ(), 1.335));
  EXPECT_TRUE(refract(Vec3(0.3, 0.0, 0.9).normalized(), Vec3::UnitZ(), 1.335));
}

TEST(FlatPort, FitIsExactWithoutRefraction) {
  FlatPort port;
  port.index_glass = port.index_water = 1.0;
  const CameraCalibration camera = lensInWater();
  const PortFit fit = fitRadialTangential(camera, port);
  EXPECT_LT(fit.rms_px, 1e-6);
  EXPECT_NEAR(fit.calibration.fx_px, camera.fx_px, 1e-4);
  EXPECT_NEAR(fit.calibration.cx_px, camera.cx_px, 1e-4);
  EXPECT_NEAR(fit.calibration.body_from_camera.translation.norm(), 0.0, 1e-6);
}

TEST(FlatPort, FitComesNearButCannotReachTheRefraction) {
  FlatPort port;
  port.normal_C = Vec3(0.01, 0.006, 1.0).normalized();
  const CameraCalibration air = airCameraFor(lensInWater(), port);
  EXPECT_NEAR(air.fx_px, 450.0 / 1.335, 1e-9);
  const PortFit fit = fitRadialTangential(air, port);
  // Refraction reduces the field of view by the index: the focal length returns to its original value, with
  // pincushion distortion.
  EXPECT_NEAR(fit.calibration.fx_px, 450.0, 5.0);
  EXPECT_GT(fit.calibration.distortion[0], 0.05);
  EXPECT_LT(fit.rms_px, 0.5);
  EXPECT_GT(fit.rms_px, 1e-3);
  const auto camera = makeCamera(fit.calibration);
  const auto ray = throughPort(port, *makeCamera(air)->unproject(Vec2(500.0, 130.0)));
  const Vec3 point_B = ray->origin_C + 1.5 * ray->direction_C;
  const auto pixel = camera->project(fit.calibration.body_from_camera.inverse() * point_B);
  ASSERT_TRUE(pixel);
  EXPECT_LT((*pixel - Vec2(500.0, 130.0)).norm(), 1.0);
}

TEST(FlatPort, SaysWhenNothingPasses) {
  FlatPort port;
  port.normal_C = -Vec3::UnitZ();
  EXPECT_THROW(fitRadialTangential(airCameraFor(lensInWater(), FlatPort{}), port), UsageError);
}

}  // namespace
}  // namespace lodeline
