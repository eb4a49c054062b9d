#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/earth_field/harmonic_field.h"
#include "lodeline/magnetometer/earth_field/magnetic_models.h"

namespace lodeline {
namespace {

void check(const GeodeticPosition& p, double year) {
  const double first = magneticModels().front().epoch;
  const double last = magneticModels().back().epoch + kMagneticModel_years;
  if (!(year >= first && year <= last)) {
    throw InputError(
        fmt::format("the Earth's magnetic field is known here from {:.0f} to {:.0f} (IGRF-14, then "
                    "the World Magnetic Models up to 2025), not for the year {:.3f}",
                    first, last, year));
  }
  if (!(std::abs(p.latitude_deg) <= 90.0 && std::abs(p.longitude_deg) <= 360.0)) {
    throw InputError(fmt::format("there is no place at latitude {} and longitude {} degrees", p.latitude_deg,
                                 p.longitude_deg));
  }
  if (!(p.height_m >= -10e3 && p.height_m <= 850e3)) {
    throw InputError(
        fmt::format("height {} m lies outside -10 to 850 km, where the World Magnetic Model holds; "
                    "heights are in metres",
                    p.height_m));
  }
}

/// The model for a year that check() has accepted.
const MagneticModel& modelOf(double year) {
  const std::vector<MagneticModel>& models = magneticModels();
  const auto after = std::upper_bound(models.begin(), models.end(), year,
                                      [](double y, const MagneticModel& model) { return y < model.epoch; });
  return *std::prev(after);
}

}  // namespace

const char* magneticModelName(double decimal_year) { return modelOf(decimal_year).name; }

FieldElements fieldElements(const Vec3& field_ENU) {
  FieldElements e;
  e.horizontal_T = std::hypot(field_ENU.x(), field_ENU.y());
  e.total_T = field_ENU.norm();
  e.declination_rad = std::atan2(field_ENU.x(), field_ENU.y());
  e.inclination_rad = std::atan2(-field_ENU.z(), e.horizontal_T);
  return e;
}

MagneticField worldMagneticField(const GeodeticPosition& p, double decimal_year) {
  check(p, decimal_year);
  const MagneticModel& model = modelOf(decimal_year);
  const Vec3 geocentric_m = geocentricPosition(p);
  const Vec3 rate = harmonicField(model.coefficients, &GaussCoefficient::g_nT_per_year,
                                  &GaussCoefficient::h_nT_per_year, geocentric_m);
  const Vec3 at_epoch =
      harmonicField(model.coefficients, &GaussCoefficient::g_nT, &GaussCoefficient::h_nT, geocentric_m);
  const Vec3 field = at_epoch + (decimal_year - model.epoch) * rate;
  const Mat3 geocentric_from_enu = geocentricFromEnu(p);
  constexpr double kTeslaPerNanotesla = 1e-9;
  return {kTeslaPerNanotesla * (geocentric_from_enu.transpose() * field),
          kTeslaPerNanotesla * (geocentric_from_enu.transpose() * rate)};
}

double decimalYear(const std::string& date) {
  int year = 0, month = 0, day = 0, read = 0;
  const bool parsed = std::sscanf(date.c_str(), "%4d-%2d-%2d%n", &year, &month, &day, &read) == 3 &&
                      read == static_cast<int>(date.size()) && year > 0 && month > 0 && day > 0;
  using namespace std::chrono;
  const year_month_day calendar{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                std::chrono::day(static_cast<unsigned>(day))};
  if (!parsed || !calendar.ok()) {
    throw UsageError(fmt::format("'{}' is no date; write it as YYYY-MM-DD, e.g. 2026-11-21", date));
  }
  const auto newYear = [](std::chrono::year y) { return sys_days(y / January / 1); };
  const double passed = (sys_days(calendar) - newYear(calendar.year())).count();
  const double length = (newYear(calendar.year() + years(1)) - newYear(calendar.year())).count();
  return year + passed / length;
}

}  // namespace lodeline
