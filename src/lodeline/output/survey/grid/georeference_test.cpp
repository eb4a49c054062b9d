#include "lodeline/output/survey/grid/georeference.h"

#include <gtest/gtest.h>

#include <GeographicLib/Geodesic.hpp>

#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

TEST(Georeference, PutsTheOriginWhereItWasGiven) {
  const GeodeticPosition place = {29.83, -82.60, 10.0};
  const Georeference reference(place, MapGrid("auto", place));
  EXPECT_EQ(reference.gridDescription().name, "UTM17N");
  EXPECT_EQ(reference.gridDescription().code, "EPSG:32617");
  // By PROJ 9.1: echo "-82.6 29.83" | proj +proj=utm +zone=17 +ellps=WGS84.
  const Vec3 grid = reference.grid(Vec3::Zero());
  EXPECT_NEAR(grid.x(), 345411.138, 1e-3);
  EXPECT_NEAR(grid.y(), 3301022.078, 1e-3);
  EXPECT_DOUBLE_EQ(grid.z(), 10.0);
}

TEST(Georeference, AgreesWithGeodesicsOnTheEllipsoid) {
  const GeodeticPosition place = {-33.8, 150.2, 0.0};
  const Georeference reference(place, MapGrid("auto", place));
  for (double azimuth_deg : {10.0, 120.0, 255.0}) {
    const double azimuth = azimuth_deg * kDegree;
    const GeodeticPosition position =
        reference.geodetic(2000.0 * Vec3(std::sin(azimuth), std::cos(azimuth), 0.0));
    double distance_m, azimuth1_deg, azimuth2_deg;
    GeographicLib::Geodesic::WGS84().Inverse(place.latitude_deg, place.longitude_deg, position.latitude_deg,
                                             position.longitude_deg, distance_m, azimuth1_deg, azimuth2_deg);
    EXPECT_NEAR(distance_m, 2000.0, 1e-3);
    EXPECT_NEAR(std::remainder(azimuth1_deg - azimuth_deg, 360.0), 0.0, 1e-4);
  }
}

TEST(Georeference, ConvergenceTurnsTrueIntoGridAzimuths) {
  const GeodeticPosition place = {29.83, -82.60, 0.0};
  const Georeference reference(place, MapGrid("auto", place));
  EXPECT_NEAR(reference.convergence_rad() / kDegree, -0.796, 1e-3);
  const Vec3 north = reference.grid(Vec3(0.0, 10.0, 0.0)) - reference.grid(Vec3::Zero());
  EXPECT_NEAR(std::atan2(north.x(), north.y()), -reference.convergence_rad(), 1e-6);
  EXPECT_NEAR(north.norm(), 10.0 * reference.scale(), 1e-6);
  EXPECT_LT(
      (turnedClockwise(north, reference.convergence_rad()) - Vec3(0.0, 10.0 * reference.scale(), 0.0)).norm(),
      1e-4);
}

TEST(Georeference, KeepsHeightsAlongThePlumbLine) {
  const GeodeticPosition place = {46.0, 14.0, 500.0};
  const Georeference reference(place, MapGrid("auto", place));
  EXPECT_DOUBLE_EQ(reference.grid(Vec3(3000.0, 0.0, -40.0)).z(), 460.0);
  EXPECT_DOUBLE_EQ(reference.geodetic(Vec3(3000.0, 0.0, -40.0)).height_m, 460.0);
}

TEST(Georeference, GoesOnCountingAcrossTheEquator) {
  const GeodeticPosition place = {0.0001, 30.0, 0.0};
  const Georeference reference(place, MapGrid("auto", place));
  const double step = reference.grid(Vec3(0.0, 50.0, 0.0)).y() - reference.grid(Vec3(0.0, -50.0, 0.0)).y();
  EXPECT_NEAR(step, 100.0, 0.1);
}

}  // namespace
}  // namespace lodeline
