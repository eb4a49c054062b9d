#pragma once

#include <optional>
#include <string>

namespace lodeline {

constexpr double kMetresPerFoot = 0.3048;  ///< international foot

/// Latitude and longitude as written, with a height if there is one.
struct AnglePair {
  double latitude_deg = 0.0, longitude_deg = 0.0;
  std::optional<double> height_m;
};

/// Reads latitude and longitude in degrees, minutes and seconds: signs or letters N, S, E, W before or after
/// the numbers, the marks ° ' " or d m s, colons, or blanks between the numbers; letters are then necessary.
/// A number after both angles is the height, in metres or with the unit "ft". Nothing where the text is
/// something else, minutes or seconds reach 60, or a sign contradicts a letter.
std::optional<AnglePair> parseAngles(const std::string& text);

}  // namespace lodeline
