#include <fmt/format.h>

#include "lodeline/output/survey/formats/gis/xml_text.h"
#include "lodeline/output/survey/formats/write_formats.h"
#include "lodeline/output/survey/map/map_times.h"

namespace lodeline {
namespace {

/// Path length between points of the track.
constexpr double kTrackSpacing_m = 0.1;

std::string point(const DiveMap& map, const char* element, const Vec3& point_ENU, Time time,
                  const std::string& more) {
  const GeodeticPosition position = map.place->geodetic(point_ENU);
  const std::optional<std::string> iso = isoTime(time);
  return fmt::format("<{0} lat=\"{1:.9f}\" lon=\"{2:.9f}\"><ele>{3:.3f}</ele>{4}{5}</{0}>\n", element,
                     position.latitude_deg, position.longitude_deg, position.height_m,
                     iso ? fmt::format("<time>{}</time>", *iso) : "", more);
}

std::string trackText(const DiveMap& map) {
  std::string text;
  const std::vector<StampedPose>& poses = map.trajectory.poses;
  size_t last = 0;
  for (size_t i = 0; i < poses.size(); ++i) {
    const Vec3& position = poses[i].world_from_body.translation;
    const bool is_end = i == 0 || i + 1 == poses.size();
    if (!is_end && (position - poses[last].world_from_body.translation).norm() < kTrackSpacing_m) continue;
    last = i;
    text += point(map, "trkpt", position, poses[i].time, "");
  }
  return text;
}

}  // namespace

std::string gpxText(const DiveMap& map) {
  std::string notes;
  for (const std::string& note : map.notes) notes += note + "\n";
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<gpx version=\"1.1\" creator=\"Lodeline\" xmlns=\"http://www.topografix.com/GPX/1/1\">\n"
      "<metadata><name>{}</name><desc>{}</desc></metadata>\n",
      xmlEscaped(map.title), xmlEscaped(notes));
  for (size_t i = 0; i < map.survey.stations.size(); ++i) {
    const SurveyStation& station = map.survey.stations[i];
    text += point(
        map, "wpt", station.position_ENU, station.time,
        fmt::format("<name>{}</name><desc>depth {:.1f} m</desc>", i, map.depth_m(station.position_ENU)));
  }
  return text + fmt::format("<trk><name>{}</name><trkseg>\n", xmlEscaped(map.title)) + trackText(map) +
         "</trkseg></trk>\n</gpx>\n";
}

}  // namespace lodeline
