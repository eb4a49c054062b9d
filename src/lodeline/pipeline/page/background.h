#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace lodeline {

/// A map to be drawn under the plan of the report page, in the format of the page (`Background` in
/// web/src/data.ts): a PNG or JPEG image with a world file beside it (.pgw, .jgw or .wld, ESRI), or the lines
/// of a GeoJSON file.
///
/// `at`: the place of the first pose. LAT,LON in degrees for GeoJSON in longitudes and latitudes; otherwise
/// E,N or E,N,TURN in metres of the file's grid. TURN (degrees, clockwise) is the direction of the grid's
/// north seen from the north of the page, such as the negative meridian convergence; 0 if not stated. Throws
/// UsageError where `at` is no such place, InputError where the file cannot be used.
nlohmann::ordered_json readBackground(const std::filesystem::path& file, const std::string& at);

}  // namespace lodeline
