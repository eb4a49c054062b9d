#include <fmt/format.h>

#include "lodeline/export/survey_text.h"
#include "lodeline/export/write_formats.h"

namespace lodeline {
namespace {

using namespace survey_text;

/// Offset of a point from the first station as Therion wants it: it turns what it gets by the convergence at
/// the first station, so grid differences are turned against that.
Vec3 fromFirst(const DiveMap& map, const Vec3& point_ENU) {
  const Vec3 first_ENU = map.survey.stations.front().position_ENU;
  if (!map.place) return point_ENU - first_ENU;
  return turnedClockwise(map.place->grid(point_ENU) - rounded(map.place->grid(first_ENU)),
                         map.place->convergence_rad());
}

std::string therionFix(const DiveMap& map) {
  if (!map.place) return fmt::format("    fix 0 0 0 {:.4f}\n", -map.start_depth_m + 0.0);
  const UtmZone& zone = map.place->zone();
  const Vec3 first = rounded(map.place->grid(map.survey.stations.front().position_ENU));
  return fmt::format("    cs UTM{}{}\n    fix 0 {:.4f} {:.4f} {:.4f} {:g} {:g} {:g}\n", zone.number,
                     zone.north ? "" : "S", first.x(), first.y(), first.z(), map.place_sigma.x(),
                     map.place_sigma.y(), map.place_sigma.z());
}

/// Therion 6.1 warns of dates after 2024, where its model of declination ends, also where no declination is
/// asked of it.
std::string dateText(const DiveMap& map) {
  if (map.date.empty()) return "";
  if (map.date < "2025") return fmt::format("    date {}\n", dotted(map.date));
  return fmt::format("    # date {}  (Therion 6.1 warns of dates after 2024)\n", dotted(map.date));
}

std::string therionSplays(const DiveMap& map) {
  std::string text;
  for (size_t i = 0; i < map.survey.stations.size(); ++i) {
    const SurveyStation& station = map.survey.stations[i];
    const Vec3 origin = fromFirst(map, station.position_ENU);
    for (const Vec3& target : station.splays_ENU)
      text += splay(i, ".", fromFirst(map, target) - origin, "    ");
  }
  if (text.empty()) return "";
  return "\n    # To the walls, from points of the map.\n    data normal from to tape compass clino\n"
         "    declination 0 degrees\n    flags splay\n" +
         text + "    flags not splay\n";
}

std::string dimensionsText(const Survey& survey) {
  std::string text;
  for (size_t i = 0; i < survey.stations.size(); ++i) {
    const PassageSize& size = survey.stations[i].passage;
    if (!size.isComplete()) continue;
    text +=
        fmt::format("    {} {:.2f} {:.2f} {:.2f} {:.2f}\n", i, *size.left, *size.right, *size.up, *size.down);
  }
  if (text.empty()) return "";
  return "\n    # Distances to the walls: median of the points of the map within 30 degrees of each "
         "direction.\n"
         "    data dimensions station left right up down\n" +
         text;
}

}  // namespace

std::string therionText(const DiveMap& map) {
  const Survey& survey = map.survey;
  std::vector<Vec3> positions;
  for (const SurveyStation& station : survey.stations)
    positions.push_back(fromFirst(map, station.position_ENU));
  std::string text = fmt::format("encoding utf-8\n# {}\n", map.title) + comments(map, "#");
  text += fmt::format("\nsurvey {} -title {}\n  centreline\n", map.name, quoted(map.title)) + dateText(map);
  for (const std::string& name : map.team) text += fmt::format("    team {}\n", quoted(name));
  text += therionFix(map) + "    station 0 \"entrance\" entrance\n";
  const Vec3& sigma = survey.leg_sigma_ENU;
  text += fmt::format(
      "\n    # Differences against the north named above; Therion turns them by the convergence of the "
      "meridians.\n"
      "    declination 0 degrees\n    data cartesian from to dx dy dz\n"
      "    sd dx {:.4f} metres\n    sd dy {:.4f} metres\n    sd dz {:.4f} metres\n",
      sigma.x(), sigma.y(), sigma.z());
  text += legs(positions, "    ");
  if (survey.is_closed) text += fmt::format("    equate 0 {}\n", survey.legs());
  text += therionSplays(map) + dimensionsText(survey);
  return text + "  endcentreline\nendsurvey\n";
}

std::string therionConfig(const DiveMap& map) {
  std::string text = fmt::format("encoding utf-8\nsource {}.th\n", map.name);
  if (map.place) {
    text += fmt::format("cs UTM{}{}\n", map.place->zone().number, map.place->zone().north ? "" : "S");
    text += fmt::format("export model -fmt kml -o {}_therion.kml\n", map.name);
  }
  return text + fmt::format("export model -o {0}.lox\nexport survey-list -o {0}_surveys.html\n", map.name);
}

}  // namespace lodeline
