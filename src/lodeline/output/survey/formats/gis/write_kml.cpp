#include <fmt/format.h>

#include "lodeline/output/survey/formats/gis/xml_text.h"
#include "lodeline/output/survey/formats/write_formats.h"
#include "lodeline/output/survey/map/map_times.h"

namespace lodeline {
namespace {

std::string kmlCoordinates(const DiveMap& map, const Vec3& point_ENU) {
  const GeodeticPosition position = map.place->geodetic(point_ENU);
  return fmt::format("{:.9f},{:.9f},{:.3f}", position.longitude_deg, position.latitude_deg,
                     position.height_m);
}

std::string lineCoordinates(const DiveMap& map) {
  std::string text;
  for (const SurveyStation& station : map.survey.stations)
    text += kmlCoordinates(map, station.position_ENU) + '\n';
  return text;
}

std::string linePlacemark(const DiveMap& map, const char* name, const char* altitude_mode, bool is_visible) {
  return fmt::format(
      "<Placemark><name>{}</name><visibility>{}</visibility><styleUrl>#line</styleUrl>\n"
      "<LineString><tessellate>1</tessellate><altitudeMode>{}</altitudeMode><coordinates>\n{}</coordinates>"
      "</LineString></Placemark>\n",
      name, is_visible ? 1 : 0, altitude_mode, lineCoordinates(map));
}

std::string sizeText(const PassageSize& size) {
  std::string text;
  const auto add = [&text](const char* name, const std::optional<double>& value) {
    if (value) text += fmt::format(", {} {:.1f} m", name, *value);
  };
  add("left", size.left);
  add("right", size.right);
  add("up", size.up);
  add("down", size.down);
  return text;
}

std::string stationPlacemark(const DiveMap& map, size_t i) {
  const SurveyStation& station = map.survey.stations[i];
  std::string details = sizeText(station.passage);
  if (const std::optional<std::string> time = isoTime(station.time)) details.append(", ").append(*time);
  return fmt::format(
      "<Placemark><name>{}</name><description>depth {:.1f} m{}</description><styleUrl>#station</styleUrl>\n"
      "<Point><altitudeMode>clampToGround</altitudeMode><coordinates>{}</coordinates></Point></Placemark>\n",
      i, map.depth_m(station.position_ENU), details, kmlCoordinates(map, station.position_ENU));
}

constexpr const char* kStyles =
    "<Style id=\"line\"><LineStyle><color>ff00a5ff</color><width>3</width></LineStyle></Style>\n"
    "<Style id=\"station\"><IconStyle><scale>0.4</scale><Icon>"
    "<href>http://maps.google.com/mapfiles/kml/shapes/shaded_dot.png</href></Icon></IconStyle>"
    "<LabelStyle><scale>0.7</scale></LabelStyle></Style>\n";

}  // namespace

std::string kmlText(const DiveMap& map) {
  std::string notes;
  for (const std::string& note : map.notes) notes += note + "\n";
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml "
      "xmlns=\"http://www.opengis.net/kml/2.2\">\n<Document>\n"
      "<name>{}</name>\n<description>{}</description>\n{}",
      xmlEscaped(map.title), xmlEscaped(notes), kStyles);
  // Viewers hide objects below the terrain. The line at its height is visible only with transparent ground,
  // so new users see the one on the ground.
  text += linePlacemark(map, "Line, on the ground above", "clampToGround", true);
  text += linePlacemark(map, "Line, at its height (below ground: make the terrain transparent)", "absolute",
                        false);
  text += "<Folder><name>Stations</name>\n";
  for (size_t i = 0; i < map.survey.stations.size(); ++i) text += stationPlacemark(map, i);
  return text + "</Folder>\n</Document>\n</kml>\n";
}

}  // namespace lodeline
