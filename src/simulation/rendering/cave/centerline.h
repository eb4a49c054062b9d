#pragma once

#include <cstdint>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// One cross-section of a passage.
struct PassageStation {
  /// Arc length along the centreline, m; 0 at the start of the dive, negative towards the entrance.
  double arc_length_m = 0.0;
  Vec3 position_W = Vec3::Zero();  ///< middle of the passage, m, ENU
  Vec3 tangent_W = Vec3::UnitX();  ///< unit, towards the far end
  double width_m = 0.0;            ///< horizontal, between the walls, normal to the tangent
  double height_m = 0.0;           ///< from floor to ceiling
};

/// Limits of the diver's corridor, as fractions of the passage's half width and half height, plus
/// kCorridorSway_m. The origin of the diver frame stays inside it; walls and furniture stay outside.
constexpr double kCorridorShareOfHalfWidth = 0.45;
constexpr double kCorridorShareOfHalfHeight = 0.35;
constexpr double kCorridorSway_m = 0.1;

/// Large-scale shape of a passage. All lengths in m.
struct CenterlineOptions {
  uint64_t seed = 1;
  double length_m = 110.0;  ///< from the start of the dive to its far end
  double lead_in_m = 12.0;  ///< passage before the start of the dive
  double run_out_m = 15.0;  ///< passage beyond the far end
  double station_spacing_m = 0.25;
  double main_azimuth_rad = 0.6;  ///< mean direction, clockwise from north
  double bend_rad = 0.6;          ///< RMS angle to the mean direction; never above 75 degrees
  double shortest_bend_m = 22.0;  ///< wavelengths of the bends are between this and six times this
  double descent_m = 8.0;         ///< depth of the far end below the start
  double undulation_m = 0.8;      ///< RMS height variation in addition
  double mean_width_m = 4.5;
  double mean_height_m = 2.8;
  double section_variation = 0.3;  ///< RMS relative change of width and height
};

/// The middle line of a passage with its cross-sections: open with two ends, or closed to a circuit.
class Centerline {
 public:
  /// A random winding passage. It always advances along its main azimuth, so it never intersects itself.
  /// Throws UsageError where an option is not positive or not finite.
  static Centerline generate(const CenterlineOptions& options);

  /// A line through two or more stations with even spacing in arc length. In a circuit, the first station
  /// follows the last one at the same spacing.
  static Centerline through(std::vector<PassageStation> stations, bool closed);

  /// Stations with even spacing in arc length.
  const std::vector<PassageStation>& stations() const { return stations_; }
  bool closed() const { return closed_; }
  double beginArcLength() const { return stations_.front().arc_length_m; }
  /// In a circuit, the arc length at which the first station is reached again.
  double endArcLength() const { return stations_.back().arc_length_m + (closed_ ? spacing_m_ : 0.0); }
  double length_m() const { return endArcLength() - beginArcLength(); }

  /// Interpolated station (cubic Hermite in position). Beyond the ends, straight extrapolation; in a circuit,
  /// any arc length is valid, and the station states the given one.
  PassageStation at(double arc_length_m) const;

  /// Arc length of the station nearest to a point, among those within `window_m` of `near_arc_length_m`.
  double nearestArcLength(const Vec3& point_W, double near_arc_length_m, double window_m) const;

  /// The same passage shifted by `offset_W`.
  Centerline translated(const Vec3& offset_W) const;

  /// The same passage in the other direction: `zero_arc_length_m` becomes zero.
  Centerline reversed(double zero_arc_length_m) const;

 private:
  std::vector<PassageStation> stations_;
  bool closed_ = false;
  double spacing_m_ = 0.0;
};

}  // namespace lodeline
