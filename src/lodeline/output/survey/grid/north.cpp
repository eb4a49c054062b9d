#include "lodeline/output/survey/grid/north.h"

#include <fmt/format.h>

#include "lodeline/diagnostics.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

North magneticNorth(const std::optional<GeodeticPosition>& place, const std::string& date) {
  North north;
  north.text = "magnetic north; no declination applied (that takes --entrance and --date)";
  if (!place) return north;
  if (date.empty()) {
    throw UsageError(
        "the run's heading counts from magnetic north: give --date YYYY-MM-DD for its declination, or "
        "--turn DEG");
  }
  try {
    north.turn_rad = fieldElements(worldMagneticField(*place, decimalYear(date)).field_ENU).declination_rad;
  } catch (const InputError& error) {
    throw InputError(fmt::format("declination: {}; or give it by hand with --turn DEG", error.what()));
  }
  north.is_true = true;
  north.text = fmt::format(
      "true north: the run's magnetic north, declination {:.2f} deg applied ({}, "
      "entrance, {})",
      north.turn_rad / kDegree, magneticModelName(decimalYear(date)), date);
  return north;
}

}  // namespace

North findNorth(HeadingReference reference, const std::optional<GeodeticPosition>& place,
                const std::string& date, std::optional<double> turn_deg) {
  if (turn_deg) {
    return {*turn_deg * kDegree, true,
            fmt::format("true north: {} of the run, turned clockwise by {:g} deg (--turn)",
                        toString(reference), *turn_deg)};
  }
  if (reference == HeadingReference::True) {
    return {0.0, true, "true north, as the run found it; no declination applied"};
  }
  if (reference == HeadingReference::Magnetic) return magneticNorth(place, date);
  if (place) {
    throw UsageError(
        "the run's heading counts from its start, not from north (no calibrated magnetometer): give "
        "--turn DEG, the true azimuth of the run's y axis, or leave --entrance out");
  }
  return {0.0, false, "arbitrary: heading counts from the start of the run",
          "x, y from the start heading, z up"};
}

}  // namespace lodeline
