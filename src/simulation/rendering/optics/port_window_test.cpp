// Ports, dispersion and refractive indices against published values, closed forms and the library's ports.
#include "simulation/rendering/optics/port_window.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "lodeline/util/angles.h"
#include "simulation/rendering/optics/camera_optics.h"
#include "simulation/rendering/optics/dispersion.h"
#include "simulation/rendering/optics/port_fit.h"
#include "simulation/rendering/optics/test_lens.h"
#include "simulation/rendering/optics/water_index.h"

namespace lodeline {
namespace {

DomePort decentred(const Vec3& centre_C) {
  DomePort port;
  port.centre_C = centre_C;
  return port;
}

CameraOptics opticsBehind(const PortWindow& port) {
  IntrinsicsOptions lens;
  lens.port = port;
  return CameraOptics(airCameraFor(lensInWater(), port), lens);
}

TEST(DomePort, BendsNothingAboutTheLens) {
  const Vec3 direction = Vec3(0.4, -0.3, 1.0).normalized();
  const auto ray = throughPort(decentred(Vec3::Zero()), direction);
  ASSERT_TRUE(ray);
  EXPECT_LT((ray->direction_C - direction).norm(), 1e-14);
  EXPECT_NEAR(ray->origin_C.norm(), 0.049, 1e-14);
}

TEST(DomePort, ADecentringOfMillimetresBendsByArcMinutesAndMovesPixels) {
  const CameraOptics centred = opticsBehind(decentred(Vec3::Zero()));
  for (const double off_m : {0.001, 0.003}) {
    const CameraOptics optics = opticsBehind(decentred(Vec3(off_m, 0.0, 0.0)));
    const auto ray = centred.ray(Vec2(322.0, 239.0));
    const Vec3 point_C = ray->origin_C + 2.0 * ray->direction_C;
    const auto pixel = optics.pixelOf(point_C, Vec2(322.0, 239.0));
    ASSERT_TRUE(pixel);
    // Near the axis the two spheres act as a thin lens of the power -(n_w - 1) / R, decentred by `off_m`:
    // the light turns by off_m (n_w - 1) / R / n_w.
    const double expected_px = 450.0 * off_m * 0.335 / 0.047 / 1.335;
    EXPECT_NEAR(std::abs(pixel->x() - 322.0), expected_px, 0.25 * expected_px);
    EXPECT_NEAR(pixel->y(), 239.0, 1e-6);
  }
}

TEST(DomePort, RefusesALensOutside) {
  EXPECT_FALSE(throughPort(decentred(Vec3(0.0, 0.0, 0.1)), Vec3::UnitZ()));
}

// The library solves the same light path with other equations.
TEST(PortWindow, AgreesWithThePortsOfTheLibraryBothWays) {
  FlatPort plate;
  plate.normal_C = Vec3(std::sin(kDegree), 0.0, std::cos(kDegree));
  const DomePort dome = decentred(Vec3(0.001, -0.002, 0.002));
  for (const PortWindow& window : {PortWindow(plate), PortWindow(dome)}) {
    CameraCalibration calibration = airCameraFor(lensInWater(), window);
    calibration.port = Port{};
    if (window.index() == 0) {
      calibration.port->normal_C = plate.normal_C;
      calibration.port->distance_m = plate.distance_m;
      calibration.port->thickness_m = plate.thickness_m;
    } else {
      calibration.port->type = Port::Type::Dome;
      calibration.port->centre_C = dome.centre_C;
      calibration.port->radius_m = dome.radius_m;
      calibration.port->thickness_m = dome.thickness_m;
    }
    calibration.port->index_water = waterIndex(window);
    const auto library = makeCamera(calibration);
    const CameraOptics optics = opticsBehind(window);
    for (const Vec2& pixel : {Vec2(30, 20), Vec2(320, 240), Vec2(600, 100), Vec2(250, 470)}) {
      const auto ray = optics.ray(pixel);
      ASSERT_TRUE(ray);
      for (const double range_m : {0.3, 5.0}) {
        const Vec3 point_C = ray->origin_C + range_m * ray->direction_C;
        const auto projected = library->project(point_C);
        ASSERT_TRUE(projected);
        EXPECT_LT((*projected - pixel).norm(), 1e-6);
        const auto back = optics.pixelOf(point_C, pixel + Vec2(6.0, -4.0));
        ASSERT_TRUE(back);
        EXPECT_LT((*back - pixel).norm(), 1e-7);
      }
    }
  }
}

TEST(PortWindow, ATiltOfOneDegreeBendsTheAxisByAQuarterDegree) {
  FlatPort port;
  port.normal_C = Vec3(std::sin(kDegree), 0.0, std::cos(kDegree));
  const auto ray = throughPort(port, Vec3::UnitZ());
  ASSERT_TRUE(ray);
  // For small angles, the axis turns towards the normal by (1 - 1 / n) of the tilt.
  EXPECT_NEAR(std::atan2(ray->direction_C.x(), ray->direction_C.z()), kDegree * (1.0 - 1.0 / 1.335), 1e-6);
}

TEST(WaterIndex, FollowsPublishedValues) {
  // A. Harvey, J. Gallagher and J. Levelt Sengers, J. Phys. Chem. Ref. Data 27, 1998: 1.33343 at 589 nm and
  // 20 C relative to vacuum, that is 1.33306 relative to air; this equation is within 0.0002.
  EXPECT_NEAR(waterIndexAt(0.0, 20.0, 589.26), 1.3331, 4e-4);
  EXPECT_NEAR(waterIndexAt(35.0, 25.0, 550.0) - waterIndexAt(0.0, 25.0, 550.0), 0.0064, 3e-4);
  EXPECT_NEAR(waterIndexAt(0.0, 25.0, 450.0) - waterIndexAt(0.0, 25.0, 650.0), 0.0076, 8e-4);
  EXPECT_NEAR(acrylicDispersion(486.1) - acrylicDispersion(656.3), 0.0088, 3e-4);
  EXPECT_NEAR(waterDensity_kg_per_m3(34.0) / waterDensity_kg_per_m3(0.0), 1.0257, 5e-4);
}

TEST(Dispersion, ShiftsColoursRadiallyByTheSlopeOfSnellsLaw) {
  const CameraOptics optics = opticsBehind(FlatPort{});
  const Dispersion dispersion(optics);
  const double f_air = 450.0 / 1.335;
  for (const double radius_px : {100.0, 200.0, 300.0}) {
    // sin(air) = n sin(water): dr = f tan(a) / cos^2(a) dn / n. A colour of higher index is seen further out,
    // so the same ray in the middle colour is further in.
    const double angle = std::atan(radius_px / f_air);
    for (const int band : {0, 4}) {
      const double step = waterIndexAt(0.0, 25.0, kSpectralBands[band].wavelength_nm) -
                          waterIndexAt(0.0, 25.0, kMiddleWavelength_nm);
      const double expected_px = -radius_px / std::pow(std::cos(angle), 2.0) * step / 1.335;
      const Vec2 shift = dispersion.shift(band, 322.0 + radius_px, 239.0);
      EXPECT_NEAR(shift.x(), expected_px, 0.06 * std::abs(expected_px) + 0.01) << radius_px << " " << band;
      EXPECT_NEAR(shift.y(), 0.0, 0.01);
    }
  }
  EXPECT_LT(dispersion.shift(0, 322.0, 239.0).norm(), 0.02);
  // The water takes red first: the centroid of a far point moves with the blue light, outwards.
  const double near_px = dispersion.meanShift(622.0, 239.0, 0.5f).x();
  const double far_px = dispersion.meanShift(622.0, 239.0, 5.0f).x();
  EXPECT_LT(far_px, near_px - 0.3);
  EXPECT_GT(far_px, near_px - 2.0);
}

TEST(Dispersion, SmearsAPointAtTheEdgeAndKeepsItsLight) {
  const CameraOptics optics = opticsBehind(FlatPort{});
  const Dispersion dispersion(optics);
  cv::Mat image(480, 640, CV_32F, cv::Scalar(0)), range(480, 640, CV_32F, cv::Scalar(2.0f));
  image.at<float>(239, 322) = image.at<float>(239, 620) = 1.0f;
  dispersion.smear(image, range);
  const cv::Mat centre = image(cv::Rect(312, 229, 21, 21)), edge = image(cv::Rect(606, 229, 29, 21));
  EXPECT_NEAR(cv::sum(centre)[0], 1.0, 0.03);
  EXPECT_NEAR(cv::sum(edge)[0], 1.0, 0.05);
  EXPECT_GT(image.at<float>(239, 322), 0.95f);
  double brightest = 0.0;
  cv::minMaxLoc(edge, nullptr, &brightest);
  EXPECT_LT(brightest, 0.5);
}

}  // namespace
}  // namespace lodeline
