#include "lodeline/export/georeference.h"

#include <fmt/format.h>

#include <GeographicLib/UTMUPS.hpp>
#include <algorithm>
#include <cctype>
#include <numbers>

#include "lodeline/base/error.h"

namespace lodeline {

using GeographicLib::UTMUPS;

std::string UtmZone::name() const { return fmt::format("UTM{}{}", number, north ? "N" : "S"); }

int UtmZone::epsg() const { return UTMUPS::EncodeEPSG(number, north); }

UtmZone utmZone(const std::string& crs, const GeodeticPosition& place) {
  std::string name = crs;
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
  UtmZone zone;
  try {
    if (name == "AUTO") {
      zone = {UTMUPS::StandardZone(place.latitude_deg, place.longitude_deg), place.latitude_deg >= 0.0};
    } else if (name.starts_with("EPSG:")) {
      UTMUPS::DecodeEPSG(std::stoi(name.substr(5)), zone.number, zone.north);
    } else {
      if (name.starts_with("UTM")) name.erase(0, 3);
      UTMUPS::DecodeZone(name, zone.number, zone.north);
    }
  } catch (const std::exception&) {
    zone.number = 0;
  }
  if (zone.number < 1 || zone.number > 60) {
    throw UsageError(
        fmt::format("--crs {}: a UTM zone on WGS 84 is wanted, as UTM17N or EPSG:32617; `cs2cs` "
                    "of PROJ, QGIS or Survex's *cs out convert to national grids",
                    crs));
  }
  return zone;
}

Georeference::Georeference(const GeodeticPosition& origin, const UtmZone& zone)
    : origin_(origin), zone_(zone), plane_(origin.latitude_deg, origin.longitude_deg, origin.height_m) {
  double easting, northing, convergence_deg;
  int number;
  bool north;
  try {
    UTMUPS::Forward(origin.latitude_deg, origin.longitude_deg, number, north, easting, northing,
                    convergence_deg, scale_, zone.number);
  } catch (const GeographicLib::GeographicErr& error) {
    throw UsageError(
        fmt::format("{:.5f}, {:.5f} cannot be given in {}: {}; leave --crs out for the zone of "
                    "the entrance",
                    origin.latitude_deg, origin.longitude_deg, zone.name(), error.what()));
  }
  convergence_rad_ = convergence_deg * std::numbers::pi / 180.0;
}

GeodeticPosition Georeference::geodetic(const Vec3& point_ENU) const {
  GeodeticPosition position;
  double height_above_plane_m;
  plane_.Reverse(point_ENU.x(), point_ENU.y(), point_ENU.z(), position.latitude_deg, position.longitude_deg,
                 height_above_plane_m);
  position.height_m = origin_.height_m + point_ENU.z();
  return position;
}

Vec3 Georeference::grid(const Vec3& point_ENU) const {
  const GeodeticPosition position = geodetic(point_ENU);
  double easting, northing, convergence_deg, scale;
  int number;
  bool north;
  UTMUPS::Forward(position.latitude_deg, position.longitude_deg, number, north, easting, northing,
                  convergence_deg, scale, zone_.number);
  // Near the equator a point may lie in the other hemisphere; its northing goes on counting in the zone's.
  if (north != zone_.north) northing += zone_.north ? -UTMUPS::UTMShift() : UTMUPS::UTMShift();
  return {easting, northing, position.height_m};
}

Vec3 turnedClockwise(const Vec3& vector, double angle_rad) {
  return Eigen::AngleAxisd(-angle_rad, Vec3::UnitZ()) * vector;
}

}  // namespace lodeline
