#pragma once

#include <string>

#include "lodeline/types.h"

namespace lodeline {

/// The Earth's field at one place and time, in local axes east, north, up.
struct MagneticField {
  Vec3 field_ENU = Vec3::Zero();          ///< T
  Vec3 rate_ENU_per_year = Vec3::Zero();  ///< T/year, secular variation
};

/// Magnitude and direction of a field as given on charts.
struct FieldElements {
  double declination_rad = 0.0;  ///< angle of the horizontal part, clockwise from true north
  double inclination_rad = 0.0;  ///< below the horizon
  double horizontal_T = 0.0;
  double total_T = 0.0;
};
FieldElements fieldElements(const Vec3& field_ENU);

/// The Earth's main field from the model for the year: IGRF-14 from 1900.0, World Magnetic Model 2015
/// (version 2), 2020 and 2025, each from its year on (magnetic_models.h). Throws InputError where the year is
/// outside 1900.0 to 2030.0. Also throws it for a latitude beyond the poles, a longitude beyond +-360, or a
/// height outside -10 to 850 km. The models are specified from one kilometre below to 850 km above sea level;
/// caves and mines may be deeper.
MagneticField worldMagneticField(const GeodeticPosition& position, double decimal_year);

/// Name of the model that worldMagneticField() uses for a year within its range: "WMM2025".
const char* magneticModelName(double decimal_year);

/// Decimal year of a calendar date (Gregorian), e.g. 2026-11-21 -> 2026.8877. Throws UsageError for a date
/// that does not exist or is not written YYYY-MM-DD.
double decimalYear(const std::string& date);

}  // namespace lodeline
