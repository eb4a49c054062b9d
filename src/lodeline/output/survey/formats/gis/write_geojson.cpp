#include <cmath>
#include <nlohmann/json.hpp>

#include "lodeline/output/survey/formats/write_formats.h"
#include "lodeline/output/survey/map/map_times.h"
#include "lodeline/util/json_text.h"

namespace lodeline {
namespace {

using Json = nlohmann::ordered_json;

/// Longitude, latitude, height above the ellipsoid. 1e-9 degrees are 0.1 mm.
Json coordinates(const DiveMap& map, const Vec3& point_ENU) {
  const GeodeticPosition position = map.place->geodetic(point_ENU);
  // Division by the inverse of a power of ten gives a number with a short decimal text.
  const auto decimals = [](double value, double per_unit) { return std::round(value * per_unit) / per_unit; };
  return {decimals(position.longitude_deg, 1e9), decimals(position.latitude_deg, 1e9),
          decimals(position.height_m + map.geoid_height_m, 1e4)};
}

Json feature(const std::string& id, Json geometry, Json properties) {
  return {{"type", "Feature"},
          {"id", id},
          {"geometry", std::move(geometry)},
          {"properties", std::move(properties)}};
}

Json lineFeature(const DiveMap& map) {
  Json line = Json::array();
  for (const SurveyStation& station : map.survey.stations)
    line.push_back(coordinates(map, station.position_ENU));
  Json properties = {{"kind", "line"}, {"name", map.title}, {"date", map.date}, {"team", map.team}};
  properties["length_m"] = std::round(map.survey.length_m() * 1e3) / 1e3;
  properties["vertical_datum"] = map.heights.name;
  properties["notes"] = map.notes;
  return feature("line", {{"type", "LineString"}, {"coordinates", line}}, properties);
}

void put(Json& properties, const char* key, const std::optional<double>& value) {
  if (value) properties[key] = std::round(*value * 1e3) / 1e3;
}

Json stationFeature(const DiveMap& map, size_t i) {
  const SurveyStation& station = map.survey.stations[i];
  Json properties = {{"kind", "station"}, {"name", std::to_string(i)}};
  put(properties, "depth_m", map.depth_m(station.position_ENU));
  if (const auto time = isoTime(station.time)) properties["time"] = *time;
  put(properties, "left_m", station.passage.left);
  put(properties, "right_m", station.passage.right);
  put(properties, "up_m", station.passage.up);
  put(properties, "down_m", station.passage.down);
  return feature("station-" + std::to_string(i),
                 {{"type", "Point"}, {"coordinates", coordinates(map, station.position_ENU)}}, properties);
}

std::optional<Json> planFeature(const DiveMap& map) {
  Json polygons = Json::array();
  for (const std::vector<Vec3>& ring : passagePlan(map.survey)) {
    Json corners = Json::array();
    for (const Vec3& corner : ring) corners.push_back(coordinates(map, corner));
    corners.push_back(corners.front());
    polygons.push_back(Json::array({corners}));
  }
  if (polygons.empty()) return std::nullopt;
  return feature("passage", {{"type", "MultiPolygon"}, {"coordinates", polygons}},
                 {{"kind", "passage"}, {"name", map.title + " (plan from widths)"}});
}

}  // namespace

std::string geojsonText(const DiveMap& map) {
  Json features = Json::array({lineFeature(map)});
  if (std::optional<Json> plan = planFeature(map)) features.push_back(std::move(*plan));
  for (size_t i = 0; i < map.survey.stations.size(); ++i) features.push_back(stationFeature(map, i));
  const Json collection = {{"type", "FeatureCollection"}, {"features", features}};
  return jsonText(collection, 1) + "\n";
}

}  // namespace lodeline
