#include <fmt/format.h>

#include <set>

#include "lodeline/output/survey/formats/survey_text.h"
#include "lodeline/output/survey/formats/therion_text.h"
#include "lodeline/output/survey/formats/write_formats.h"

namespace lodeline {
namespace {

using namespace survey_text;
using namespace therion_text;

/// The line that fixes the position of a dive's first station.
std::string fixLine(const DiveMap& map, const std::optional<Georeference>& place) {
  if (!place) return fmt::format("  fix 0@{} {}\n", map.name, localStart(map));
  const Vec3 first = rounded(place->grid(map.survey.stations.front().position_ENU));
  return fmt::format("  fix 0@{} {:.4f} {:.4f} {:.4f} {:g} {:g} {:g}\n", map.name, first.x(), first.y(),
                     first.z(), map.place_sigma.x(), map.place_sigma.y(), map.place_sigma.z());
}

std::string therionSplays(const DiveMap& map, const Offsets& fromFirst) {
  std::string text;
  for (size_t i = 0; i < map.survey.stations.size(); ++i) {
    const SurveyStation& station = map.survey.stations[i];
    const Vec3 origin = fromFirst(station.position_ENU);
    for (const Vec3& target : station.splays_ENU) text += splay(i, ".", fromFirst(target) - origin, "    ");
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
  const Offsets fromFirst(map, map.survey.stations.front().position_ENU);
  std::vector<Vec3> positions;
  for (const SurveyStation& station : survey.stations) positions.push_back(fromFirst(station.position_ENU));
  std::string text = fmt::format("encoding utf-8\n# {}\n", map.title) + comments(map, "#");
  text += fmt::format("\nsurvey {} -title {}\n  centreline\n", map.name, quoted(map.title)) + dateText(map);
  for (const std::string& name : map.team) text += fmt::format("    team {}\n", quoted(person(name)));
  text += "    station 0 \"entrance\" entrance\n";
  const Vec3& sigma = survey.leg_sigma_ENU;
  text += fmt::format(
      "\n    # Differences against the north named above; Therion turns them by the convergence of the "
      "meridians.\n"
      "    declination 0 degrees\n    data cartesian from to dx dy dz\n"
      "    sd dx {:.4f} metres\n    sd dy {:.4f} metres\n    sd dz {:.4f} metres\n",
      sigma.x(), sigma.y(), sigma.z());
  text += legs(positions, "    ");
  if (survey.is_closed) text += fmt::format("    equate 0 {}\n", survey.legs());
  text += therionSplays(map, fromFirst) + dimensionsText(survey);
  return text + "  endcentreline\nendsurvey\n";
}

std::string therionFix(const DiveMap& map) {
  const std::optional<Georeference> place = placeOf(map);
  return fmt::format(
      "encoding utf-8\n# Where the first station of {0} lies. A project of several dives that begin at one "
      "place\n"
      "# inputs this file for one of them and equates the others.\ncentreline\n{1}{2}endcentreline\n",
      map.name, csLine(place, "  "), fixLine(map, place));
}

std::string therionProject(const std::vector<DiveMap>& maps, const std::string& name,
                           const std::string& title) {
  std::string text = fmt::format("encoding utf-8\nsurvey {} -title {}\n", name, quoted(title));
  std::string equates;
  std::set<std::string> equated;
  for (const auto& [first, second] : equalStarts(maps)) {
    equates += fmt::format("  equate 0@{} 0@{}\n", first, second);
    equated.insert(second);
  }
  for (const DiveMap& map : maps) {
    text += fmt::format("  input {}.th\n", map.name);
    if (!equated.contains(map.name)) text += fmt::format("  input {}_fix.th\n", map.name);
  }
  if (!equates.empty()) text += "  centreline\n" + equates + "  endcentreline\n";
  return text + "endsurvey\n";
}

std::string therionConfig(const DiveMap& map, const std::string& name,
                          const std::vector<std::string>& sources) {
  std::string text = "encoding utf-8\n";
  for (const std::string& source : sources) text += fmt::format("source {}\n", source);
  const std::optional<Georeference> place = placeOf(map);
  text += csLine(place, "");
  if (place) text += fmt::format("export model -fmt kml -o {}_therion.kml\n", name);
  return text + fmt::format("export model -o {0}.lox\nexport survey-list -o {0}_surveys.html\n", name);
}

}  // namespace lodeline
