#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <proj.h>

#include <cmath>

#include "lodeline/output/survey/formats/test_outside_program.h"
#include "lodeline/output/survey/grid/crs_position.h"
#include "lodeline/output/survey/grid/georeference.h"
#include "lodeline/output/survey/grid/map_grid.h"
#include "lodeline/util/angles.h"

// Grids against PROJ's own program.

namespace lodeline {
namespace {

struct Case {
  const char* code;
  double latitude_deg, longitude_deg;
  bool has_northing_first = false;  ///< in the order of axes of EPSG, which cs2cs keeps
  bool counts_west_and_south = false;
};

const Case kCases[] = {{"EPSG:6372", 20.32, -87.39, true},        // Mexico, ITRF2008
                       {"EPSG:6438", 29.83, -82.60},              // Florida East, US feet
                       {"EPSG:6441", 30.2, -84.3},                // Florida North, US feet
                       {"EPSG:2225", 40.9, -123.0},               // California, NAD83, US feet
                       {"EPSG:2222", 33.5, -112.0},               // Arizona, NAD83, international feet
                       {"EPSG:26916", 20.32, -87.39},             // NAD83, UTM
                       {"EPSG:25833", 46.0, 14.0},                // ETRS89, UTM
                       {"EPSG:3035", 50.0, 10.0, true},           // ETRS89, Europe, equal areas
                       {"EPSG:2154", 44.3, 1.7},                  // Lambert-93
                       {"EPSG:27700", 54.15, -2.4},               // British grid
                       {"EPSG:2056", 46.95, 7.44},                // Swiss grid
                       {"EPSG:3765", 45.0, 15.5},                 // Croatia
                       {"EPSG:5514", 49.4, 16.7},                 // Krovak, east and north
                       {"EPSG:5513", 49.4, 16.7, true, true},     // Krovak, south and west
                       {"EPSG:2053", -29.0, 29.5, false, true},   // South Africa, west and south
                       {"EPSG:22275", -33.5, 22.2, false, true},  // Cape, west and south
                       {"EPSG:31467", 48.5, 9.4, true},           // Gauss-Krueger
                       {"EPSG:2193", -41.0, 172.5, true},         // New Zealand
                       {"EPSG:28354", -37.8, 140.8},              // Australia
                       {"EPSG:32755", -37.72, 142.9},             // south of the equator, UTM
                       {"EPSG:31983", -23.5, -45.2},              // Brazil
                       {"EPSG:2136", 6.5, -1.0},                  // Ghana, a national foot
                       {"EPSG:5041", 88.0, 30.0},                 // UPS north, easting first
                       {"EPSG:32661", 86.0, -70.0, true},         // UPS north, northing first
                       {"EPSG:5042", -84.5, 120.0},               // UPS south
                       {"EPSG:3031", -77.5, 166.7},               // Antarctica
                       {"EPSG:3413", 78.2, 15.6}};                // Arctic sea ice

/// The same by cs2cs, in its order.
Vec2 byProgram(const Case& c) {
  const std::string output = test::runIn("/", fmt::format("echo '{} {}' | cs2cs -f %.6f EPSG:4326 {}",
                                                          c.latitude_deg, c.longitude_deg, c.code))
                                 .output;
  Vec2 found(NAN, NAN);
  EXPECT_EQ(std::sscanf(output.c_str(), "%lf %lf", &found.x(), &found.y()), 2) << output;
  return found;
}

/// Easting and northing of what cs2cs gives.
Vec2 eastNorth(const Case& c, const Vec2& by_program) {
  const Vec2 east_first = c.has_northing_first ? Vec2(by_program.y(), by_program.x()) : by_program;
  return c.counts_west_and_south ? Vec2(-east_first) : east_first;
}

TEST(Cs2cs, GivesTheSameCoordinatesToAMillimetre) {
  LODELINE_NEEDS_PROGRAM("cs2cs", "proj-bin");
  for (const Case& c : kCases) {
    const MapGrid grid(c.code, {c.latitude_deg, c.longitude_deg, 0.0});
    const double unit_m = grid.description().metres_per_unit;
    const Vec2 by_program = byProgram(c);
    const Vec2 expected_m = unit_m * eastNorth(c, by_program);
    EXPECT_LT((grid.project(c.latitude_deg, c.longitude_deg) - expected_m).norm(), 1e-3) << c.code;
    // And back, from the program's own numbers. A shift of the datum takes the height along, which a grid
    // does not keep: some millimetres.
    const GeodeticPosition back =
        positionOnCrs(c.code, c.counts_west_and_south ? by_program : Vec2(expected_m / unit_m));
    constexpr double kMetresPerDegree = 111e3, kMost_m = 3e-3;
    EXPECT_LT(std::abs(back.latitude_deg - c.latitude_deg) * kMetresPerDegree, kMost_m) << c.code;
    EXPECT_LT(std::abs(back.longitude_deg - c.longitude_deg) * kMetresPerDegree *
                  std::cos(c.latitude_deg * kDegree),
              kMost_m)
        << c.code;
  }
}

// PROJ 9.1 gives factors of grids in metres with the easting first only, and leaves the datum out.
TEST(Cs2cs, ConvergenceAndScaleAreThoseOfProj) {
  PJ_CONTEXT* context = proj_context_create();
  for (const Case& c : kCases) {
    if (std::string("EPSG:25833 EPSG:2154 EPSG:32755 EPSG:5041 EPSG:5042 EPSG:3413").find(c.code) ==
        std::string::npos)
      continue;
    PJ* crs = proj_create(context, c.code);
    const PJ_FACTORS factors =
        proj_factors(crs, proj_coord(c.longitude_deg * kDegree, c.latitude_deg * kDegree, 0.0, 0.0));
    proj_destroy(crs);
    const GeodeticPosition place = {c.latitude_deg, c.longitude_deg, 0.0};
    const Georeference reference(place, MapGrid(c.code, place));
    EXPECT_NEAR(reference.convergence_rad(), factors.meridian_convergence, 1e-7) << c.code;
    EXPECT_NEAR(reference.scale(), factors.meridional_scale, 1e-7) << c.code;
  }
  proj_context_destroy(context);
}

}  // namespace
}  // namespace lodeline
