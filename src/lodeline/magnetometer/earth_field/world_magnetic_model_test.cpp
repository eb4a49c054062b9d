#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

struct ReferencePoint {
  double year, height_km, latitude, longitude, north_nT, east_nT, down_nT;
};

// From NOAA's table of test values for WMM2025; the real test reads all of it.
const ReferencePoint kReference[] = {
    {2025.0, 28, 89, -121, -255.388723, -1482.460628, 56194.288771},
    {2025.0, 18, 0, 21, 29274.811882, 659.800118, -14316.722540},
    {2025.5, 8, -66, 17, 15201.438652, -9925.501123, -30881.123197},
    {2026.5, 19, 29, 66, 32725.000691, 1278.343380, 33958.454002},
    {2027.0, 67, 72, -115, 4883.287833, 1192.857435, 55689.615237},
};

TEST(WorldMagneticModel, AgreesWithReferenceValues) {
  for (const ReferencePoint& p : kReference) {
    const Vec3 field = worldMagneticField({p.latitude, p.longitude, 1e3 * p.height_km}, p.year).field_ENU;
    EXPECT_LT((1e9 * field - Vec3(p.east_nT, p.north_nT, -p.down_nT)).cwiseAbs().maxCoeff(), 1e-3);
  }
}

// From the tables of test values that NOAA published with WMM2015v2 and WMM2020 (to 0.1 nT).
const ReferencePoint kEarlierReference[] = {
    {2015.0, 0, 80, 0, 6636.6, -451.9, 54408.9},    {2020.0, 28, 89, -121, -575.7, -1396.0, 56082.3},
    {2020.0, 18, 0, 21, 29311.2, 536.0, -14589.0},  {2020.5, 8, -66, 17, 15247.0, -9734.8, -31062.0},
    {2022.5, 60, 27, 65, 32938.8, 1025.8, 30561.3}, {2024.5, 66, -21, 32, 15510.7, -3677.9, -24502.7},
};

TEST(WorldMagneticModel, AgreesWithReferenceValuesOfEarlierModels) {
  for (const ReferencePoint& p : kEarlierReference) {
    const Vec3 field = worldMagneticField({p.latitude, p.longitude, 1e3 * p.height_km}, p.year).field_ENU;
    EXPECT_LT((1e9 * field - Vec3(p.east_nT, p.north_nT, -p.down_nT)).cwiseAbs().maxCoeff(), 0.06) << p.year;
  }
}

// Dip poles, where the field of the IGRF is vertical: NOAA's table and table 4 of P. Alken et al.,
// "International Geomagnetic Reference Field: the thirteenth generation", Earth, Planets and Space 73, 2021.
TEST(WorldMagneticModel, IsUprightAtTheDipPolesOfTheReferenceField) {
  struct Pole {
    double year, latitude, longitude, sign;
  };
  for (const Pole& pole : {Pole{1900.0, 70.46, -96.19, 1.0}, Pole{1900.0, -71.72, 148.32, -1.0},
                           Pole{1950.0, 74.64, -100.86, 1.0}, Pole{1950.0, -67.89, 143.55, -1.0},
                           Pole{2000.0, 80.972, -109.640, 1.0}, Pole{2005.0, 83.186, -118.225, 1.0},
                           Pole{2010.0, 85.020, -132.840, 1.0}, Pole{2000.0, -64.661, 138.303, -1.0},
                           Pole{2010.0, -64.432, 137.320, -1.0}}) {
    const FieldElements e =
        fieldElements(worldMagneticField({pole.latitude, pole.longitude, 0.0}, pole.year).field_ENU);
    EXPECT_GT(pole.sign * e.inclination_rad, 89.9 * kDegree) << pole.year << " " << pole.latitude;
  }
}

TEST(WorldMagneticModel, HardlyJumpsFromOneModelToTheNext) {
  for (const double year : {1945.0, 1980.0, 2005.0, 2010.0, 2015.0, 2020.0, 2025.0}) {
    const GeodeticPosition florida{29.83, -82.60, 0.0};
    const Vec3 before = worldMagneticField(florida, year - 1e-6).field_ENU;
    const Vec3 after = worldMagneticField(florida, year).field_ENU;
    EXPECT_LT((after - before).norm(), 0.25e-6) << year;
    EXPECT_STRNE(magneticModelName(2019.9), magneticModelName(2020.0));
  }
}

// Magnetic north at Punta Arenas by the program that IAGA publishes with IGRF-14: 17.16 degrees east of true
// north in 1950, and 1.98 minutes more a year.
TEST(WorldMagneticModel, GivesTheDeclinationOfOldDives) {
  const GeodeticPosition punta_arenas{-53.16, -70.91, 0.0};
  const double in_1950 = fieldElements(worldMagneticField(punta_arenas, 1950.0).field_ENU).declination_rad;
  const double in_1951 = fieldElements(worldMagneticField(punta_arenas, 1951.0).field_ENU).declination_rad;
  EXPECT_NEAR(in_1950 / kDegree, 17.16, 0.01);
  EXPECT_NEAR((in_1951 - in_1950) / kDegree * 60.0, 1.98, 0.05);
  EXPECT_STREQ(magneticModelName(1950.0), "IGRF-14");
}

void expectElements(const FieldElements& e, double d_deg, double i_deg, double f_uT) {
  EXPECT_NEAR(e.declination_rad / kDegree, d_deg, 0.005);
  EXPECT_NEAR(e.inclination_rad / kDegree, i_deg, 0.005);
  EXPECT_NEAR(1e6 * e.total_T, f_uT, 0.0006);
}

TEST(WorldMagneticModel, GivesTheFieldAtTheCaves) {
  const double year = decimalYear("2026-11-21");
  const FieldElements devils_eye = fieldElements(worldMagneticField({29.83, -82.60, 0.0}, year).field_ENU);
  expectElements(devils_eye, -6.38, 57.97, 45.560);
  EXPECT_NEAR(1e6 * devils_eye.horizontal_T, 24.165, 0.0006);
  expectElements(fieldElements(worldMagneticField({20.32, -87.39, 0.0}, year).field_ENU), -2.41, 48.91,
                 39.967);
}

TEST(WorldMagneticModel, SecularVariationIsTheDifferenceOfYears) {
  const GeodeticPosition place{45.0, 10.0, 200.0};
  const MagneticField now = worldMagneticField(place, 2026.0);
  const Vec3 later = worldMagneticField(place, 2027.0).field_ENU;
  EXPECT_LT((now.field_ENU + now.rate_ENU_per_year - later).norm(), 1e-15);
}

TEST(WorldMagneticModel, WorksAtThePolesAndRefusesWhatItWasNotMadeFor) {
  EXPECT_TRUE(worldMagneticField({90.0, 0.0, 0.0}, 2026.0).field_ENU.allFinite());
  EXPECT_THROW(worldMagneticField({0.0, 0.0, 0.0}, 1899.99), InputError);
  EXPECT_THROW(worldMagneticField({0.0, 0.0, 0.0}, 2030.01), InputError);
  EXPECT_THROW(worldMagneticField({91.0, 0.0, 0.0}, 2026.0), InputError);
  EXPECT_THROW(worldMagneticField({0.0, 0.0, 1e6}, 2026.0), InputError);
  EXPECT_THROW(worldMagneticField({std::nan(""), 0.0, 0.0}, 2026.0), InputError);
}

TEST(DecimalYear, CountsDaysOfThatYear) {
  EXPECT_DOUBLE_EQ(decimalYear("2025-01-01"), 2025.0);
  EXPECT_DOUBLE_EQ(decimalYear("2028-12-31"), 2028.0 + 365.0 / 366.0);
  EXPECT_NEAR(decimalYear("2026-11-21"), 2026.88767, 1e-5);
  for (const char* bad : {"2025-02-29", "2025-13-01", "21.11.2026", "2025-1", "", "2026-11-21x"}) {
    EXPECT_THROW(decimalYear(bad), UsageError) << bad;
  }
}

}  // namespace
}  // namespace lodeline
