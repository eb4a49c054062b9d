#pragma once

#include <optional>
#include <string>

#include "lodeline/output/survey/map/dive_map.h"

/// Shared functions of the writers for Therion.
namespace lodeline::therion_text {

/// Georeference of the map on a grid that Therion supports: the map's own grid, else the UTM zone of the
/// entrance.
std::optional<Georeference> placeOf(const DiveMap& map);

/// Positions for Therion, as offsets from the fixed station. Therion rotates them by the convergence at that
/// station, so grid differences are rotated in the opposite direction.
class Offsets {
 public:
  Offsets(const DiveMap& map, const Vec3& first_ENU);

  Vec3 operator()(const Vec3& point_ENU) const;

  const std::optional<Georeference>& place() const { return place_; }
  /// Coordinates of the fixed station, m: on the grid, else from the map's origin at the surface.
  Vec3 fixed() const;

 private:
  std::optional<Georeference> place_;
  Vec3 first_ENU_;
  double start_depth_m_;
};

/// "cs UTM17", or empty for a map without a georeference.
std::string csLine(const std::optional<Georeference>& place, const char* indent);

/// Date of the survey. Therion 6.1 warns of dates after 2024, where its declination model ends, even if it
/// needs no declination.
std::string dateText(const DiveMap& map);

/// A person's name: one or two words, or more with a slash before the surname.
std::string person(std::string name);

}  // namespace lodeline::therion_text
