#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"

#include <fmt/core.h>

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/SphericalHarmonic.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/earth_field/magnetic_models.h"

namespace lodeline {
namespace {

/// Evaluates the field of one set of Gauss coefficients (nT or nT/year).
class HarmonicSum {
 public:
  HarmonicSum(const CoefficientTable& table, double GaussCoefficient::*g, double GaussCoefficient::*h)
      : c_(storage(false)), s_(storage(true)) {
    for (const GaussCoefficient& term : table) {
      // GeographicLib stores coefficients by columns of equal order, the sine terms without the column of
      // order zero.
      c_[column(term.order) + term.degree - term.order] = term.*g;
      if (term.order > 0) {
        s_[column(term.order) - (kMagneticModelDegree + 1) + term.degree - term.order] = term.*h;
      }
    }
    sum_ = GeographicLib::SphericalHarmonic(c_, s_, kMagneticModelDegree, kReferenceRadius_m,
                                            GeographicLib::SphericalHarmonic::SCHMIDT);
  }

  // Not copyable because the sum stores the addresses of the coefficients.
  HarmonicSum(const HarmonicSum&) = delete;
  HarmonicSum& operator=(const HarmonicSum&) = delete;

  /// Field in geocentric axes, in the unit of the coefficients.
  Vec3 at(const Vec3& geocentric_m) const {
    Vec3 gradient;
    sum_(geocentric_m.x(), geocentric_m.y(), geocentric_m.z(), gradient.x(), gradient.y(), gradient.z());
    return -kReferenceRadius_m * gradient;
  }

 private:
  static constexpr double kReferenceRadius_m = 6371200.0;
  static constexpr int column(int order) {
    return order * (kMagneticModelDegree + 1) - order * (order - 1) / 2;
  }
  static std::vector<double> storage(bool sine) {
    constexpr int kTerms = (kMagneticModelDegree + 1) * (kMagneticModelDegree + 2) / 2;
    return std::vector<double>(sine ? kTerms - (kMagneticModelDegree + 1) : kTerms, 0.0);
  }

  std::vector<double> c_, s_;
  GeographicLib::SphericalHarmonic sum_;
};

void check(const GeodeticPosition& p, double year) {
  const double first = kMagneticModels.front().epoch;
  const double last = kMagneticModels.back().epoch + kMagneticModel_years;
  if (!(year >= first && year <= last)) {
    throw InputError(
        fmt::format("the Earth's magnetic field is known here from {:.0f} to {:.0f} (IGRF-12, then "
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
  const auto after = std::upper_bound(kMagneticModels.begin(), kMagneticModels.end(), year,
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
  const HarmonicSum main_field(*model.coefficients, &GaussCoefficient::g_nT, &GaussCoefficient::h_nT);
  const HarmonicSum variation(*model.coefficients, &GaussCoefficient::g_nT_per_year,
                              &GaussCoefficient::h_nT_per_year);

  Vec3 geocentric_m;
  std::vector<double> rotation(9);  // geocentric from east, north, up; row by row
  GeographicLib::Geocentric::WGS84().Forward(p.latitude_deg, p.longitude_deg, p.height_m, geocentric_m.x(),
                                             geocentric_m.y(), geocentric_m.z(), rotation);
  const Mat3 geocentric_from_enu =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data());
  const Vec3 rate = variation.at(geocentric_m);
  const Vec3 field = main_field.at(geocentric_m) + (decimal_year - model.epoch) * rate;
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
