// Ports whose camera is known in closed form, and ports that are none.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lodeline/cameras/ports/test_ports.h"
#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

CameraCalibration behind(const Port& port) {
  CameraCalibration c = test::typicalCamera(*findCameraModel("radial-tangential"), 4);
  c.port = port;
  return c;
}

std::shared_ptr<const Camera> lensOf(CameraCalibration calibration) {
  calibration.port.reset();
  return makeCamera(calibration);
}

TEST(PortLimits, ADomeAroundTheLensIsTheLens) {
  const CameraCalibration c = behind(test::domePort(Vec3::Zero(), 0.05, 0.007));
  const auto camera = makeCamera(c), lens = lensOf(c);
  for (double x = -0.8; x <= 0.8; x += 0.1) {
    for (const double range_m : {0.2, 1.0, 30.0}) {
      const Vec3 point_C = range_m * Vec3(x, 0.3 - 0.2 * x, 1.0);
      Mat23 by_point, expected_by_point;
      const auto pixel = camera->project(point_C, &by_point),
                 expected = lens->project(point_C, &expected_by_point);
      ASSERT_EQ(pixel.has_value(), expected.has_value());
      if (!pixel) continue;
      EXPECT_LT((*pixel - *expected).norm(), 1e-9);
      EXPECT_LT((by_point - expected_by_point).norm(), 1e-9 * expected_by_point.norm());
      EXPECT_LT((*camera->unproject(*pixel) - point_C.normalized()).norm(), 1e-10);
    }
  }
}

// Without distance and thickness, Snell's law at the lens remains: sin(air) = n sin(water).
TEST(PortLimits, APlateAtTheLensIsACentralCameraOfSnellsLaw) {
  const Port port = test::flatPort(Vec3::UnitZ(), 0.0, 0.0);
  const CameraCalibration c = behind(port);
  const auto camera = makeCamera(c), lens = lensOf(c);
  for (double water_rad = 0.0; water_rad < 0.6; water_rad += 0.05) {
    for (double around = 0.0; around < 6.3; around += 0.5) {
      const auto at = [&](double angle) {
        return Vec3(std::sin(angle) * std::cos(around), std::sin(angle) * std::sin(around), std::cos(angle));
      };
      const auto expected = lens->project(at(std::asin(port.index_water * std::sin(water_rad))));
      for (const double range_m : {0.1, 2.0, 50.0}) {
        const auto pixel = camera->project(range_m * at(water_rad));
        ASSERT_EQ(pixel.has_value(), expected.has_value());
        if (pixel) {
          EXPECT_LT((*pixel - *expected).norm(), 1e-9) << water_rad << ", " << range_m;
        }
      }
    }
  }
  EXPECT_FALSE(camera->project(Vec3(1.2, 0.0, 1.0))) << "beyond total reflection";
}

TEST(PortLimits, AnUprightPlateTurnsWithTheView) {
  CameraCalibration c = behind(test::flatPort(Vec3::UnitZ(), 0.02, 0.01));
  c.model = "none";
  c.distortion.clear();
  c.fy_px = c.fx_px;
  const auto camera = makeCamera(c);
  const Vec2 centre(c.cx_px, c.cy_px), upright = *camera->project(Vec3(0.4, 0.1, 0.9)) - centre;
  for (double turn = 0.0; turn < 6.3; turn += 0.4) {
    const Quat rotation(Eigen::AngleAxisd(turn, Vec3::UnitZ()));
    const Vec2 pixel = *camera->project(rotation * Vec3(0.4, 0.1, 0.9)) - centre;
    EXPECT_LT((pixel - Eigen::Rotation2Dd(turn) * upright).norm(), 1e-9);
  }
}

TEST(PortLimits, DerivativeByTheCentreIsContinuousAtAnyOffset) {
  const Vec3 point_C(0.5, -0.3, 1.2);
  PixelByPort at_centre, near_centre;
  test::makeRefractive(behind(test::domePort(Vec3::Zero(), 0.05, 0.007)))->projectByPort(point_C, &at_centre);
  for (const double offset_m : {1e-10, 1e-9, 1e-8, 1e-7}) {
    const Port port = test::domePort(Vec3(0.6, -0.48, 0.64) * offset_m, 0.05, 0.007);
    test::makeRefractive(behind(port))->projectByPort(point_C, &near_centre);
    EXPECT_LT((near_centre.leftCols<3>() - at_centre.leftCols<3>()).norm(),
              1e-4 * at_centre.leftCols<3>().norm())
        << offset_m;
  }
}

std::string refusal(const Port& port) {
  try {
    makeCamera(behind(port));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(PortLimits, NameTheValueThatIsImpossible) {
  using testing::HasSubstr;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Port flat = test::flatPort(Vec3::UnitZ(), 0.02, 0.01),
             dome = test::domePort(Vec3::Zero(), 0.05, 0.005);
  EXPECT_EQ(refusal(flat), "accepted");
  EXPECT_EQ(refusal(dome), "accepted");
  const auto with = [](Port port, const auto& change) {
    change(port);
    return port;
  };
  EXPECT_THAT(refusal(with(flat, [](Port& p) { p.normal_C = -Vec3::UnitZ(); })),
              HasSubstr("away from the view"));
  EXPECT_THAT(refusal(with(flat, [](Port& p) { p.normal_C = Vec3(0.0, 0.0, 2.0); })),
              HasSubstr("unit vector"));
  EXPECT_THAT(refusal(with(flat, [&](Port& p) { p.normal_C.x() = nan; })), HasSubstr("unit vector"));
  EXPECT_THAT(refusal(with(flat, [](Port& p) { p.distance_m = -0.01; })),
              HasSubstr("distance_m of the flat port is -0.01"));
  EXPECT_THAT(refusal(with(flat, [&](Port& p) { p.distance_m = nan; })), HasSubstr("distance_m"));
  EXPECT_THAT(refusal(with(flat, [](Port& p) { p.thickness_m = -1e-3; })),
              HasSubstr("thickness_m of the port is -0.001"));
  EXPECT_THAT(refusal(with(flat, [](Port& p) { p.index_water = 0.9; })),
              HasSubstr("refractive index of water is 0.9"));
  EXPECT_THAT(refusal(with(dome, [&](Port& p) { p.index_glass = nan; })),
              HasSubstr("refractive index of glass"));
  EXPECT_THAT(refusal(with(dome, [](Port& p) { p.radius_m = 0.0; })),
              HasSubstr("radius_m of the dome port is 0"));
  EXPECT_THAT(refusal(with(dome, [](Port& p) { p.centre_C.x() = 0.06; })),
              HasSubstr("0.06 m from the centre of the dome"));
  EXPECT_THAT(refusal(with(dome, [&](Port& p) { p.centre_C.x() = nan; })),
              HasSubstr("from the centre of the dome"));
}

}  // namespace
}  // namespace lodeline
